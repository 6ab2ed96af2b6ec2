// Reads one bulk IN endpoint as a host controller does while a program reads: takes a packet soon after it is there, checks
// its toggle and size. Driven by the world's events, so it goes on while a test does something else.
import { packetNanos } from './timing.mjs';

const POLL_NANOS = 10e3; // from the buffer's being there to the token; on a quiet bus tokens come all the time

export class BulkInPipe {
  #board;
  #host;
  #endpoint;
  #maxPacket;
  #onPacket;
  #reading = false;
  #event = null;
  toggle = 0;
  packets = 0;

  constructor(board, host, endpoint, maxPacket, onPacket) {
    this.#board = board;
    this.#host = host;
    this.#endpoint = endpoint;
    this.#maxPacket = maxPacket;
    this.#onPacket = onPacket;
  }

  pause() {
    this.#reading = false;
    this.#board.world.cancel(this.#event);
    this.#event = null;
  }

  resume() {
    this.#reading = true;
    this.armed();
  }

  /** The device has handed a buffer over. */
  armed() {
    if (this.#reading && this.#event === null) this.#event = this.#board.world.after(POLL_NANOS, () => this.#poll());
  }

  #poll() {
    this.#event = null;
    if (!this.#host.attached) return;
    const answer = this.#host.port.in(this.#host.address, this.#endpoint);
    if (typeof answer === 'string') {
      if (answer !== 'nak') this.#board.faults.add('host', `bulk IN ${this.#endpoint}: ${answer}`);
      return;
    }
    this.packets += 1;
    if (answer.pid !== this.toggle) this.#board.faults.add('host', `bulk IN ${this.#endpoint}: DATA${answer.pid} is not due`);
    if (answer.bytes.length > this.#maxPacket) this.#board.faults.add('host', `packet of ${answer.bytes.length} bytes`);
    this.toggle = answer.pid ^ 1;
    const duration = packetNanos(answer.bytes.length);
    this.#onPacket(answer.bytes, this.#board.world.now + duration);
    this.#event = this.#board.world.after(duration, () => this.#poll());
  }
}
