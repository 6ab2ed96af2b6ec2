// A strict USB host at full speed: start of frames, control transfers and bulk pipes with toggles, addresses, NAKs and time
// limits of the specification (USB 2.0, chapters 8 and 9). What the device does wrong is thrown or a fault of the board.
import { MILLISECOND } from '../board/board.mjs';
import { BulkInPipe } from './bulk_in_pipe.mjs';
import { packetNanos } from './timing.mjs';

const RETRY_NANOS = 20e3;
const LIMIT = { data: 500 * MILLISECOND, status: 50 * MILLISECOND }; // 9.2.6.4

/** A request that the device answered with STALL. */
export class Stall extends Error {}

export const request = (type, code, value = 0, index = 0, length = 0) => ({ type, code, value, index, length });

export class UsbHost {
  address = 0;
  maxPacket0 = 64;
  pipes = new Map(); // endpoint -> BulkInPipe
  attachments = []; // { at, attached }
  #board;
  #frame = 0;
  #frameEvent = null;
  #outToggles = new Map();

  constructor(board) {
    this.#board = board;
    board.onAttach((attached) => this.#attachmentChanged(attached));
  }

  get port() {
    return this.#board.chip.usb;
  }

  get attached() {
    return this.#board.running && this.port.attached;
  }

  // Bus -------------------------------------------------------------------------------------------------------------

  /** Waits until the device shows itself; false when it does not within `nanos`. */
  waitForAttach(nanos) {
    return this.#board.runUntil(() => this.attached, nanos);
  }

  /** Bus reset of 15 ms and 10 ms of recovery. busyBus: a hub's other traffic leaves no idle time. */
  reset({ busyBus = false } = {}) {
    this.#stopFrames();
    this.closePipes();
    this.address = 0;
    this.maxPacket0 = 64;
    this.#outToggles.clear();
    this.port.beginBusReset(busyBus);
    this.#board.run(15 * MILLISECOND);
    this.port.endBusReset();
    this.#startFrames();
    this.#board.run(10 * MILLISECOND);
  }

  /** Stops all traffic; the device sees it after 3 ms. */
  suspend() {
    this.#stopFrames();
    for (const pipe of this.pipes.values()) pipe.pause();
    this.#board.run(3 * MILLISECOND);
    this.port.suspend();
  }

  /** Resume signalling for 20 ms, then frames again and 10 ms of recovery. */
  resume() {
    this.port.resume();
    this.#board.run(20 * MILLISECOND);
    this.#startFrames();
    this.#board.run(10 * MILLISECOND);
    for (const pipe of this.pipes.values()) pipe.resume();
  }

  // Control transfers -----------------------------------------------------------------------------------------------

  /** Returns the bytes of a request to read. Throws Stall, or Error on anything that breaks the protocol. */
  controlIn(setup) {
    this.#setup(setup);
    const bytes = [];
    let pid = 1;
    for (;;) {
      const packet = this.#inPacket(0, pid, LIMIT.data, 'data stage');
      if (packet.length > this.maxPacket0) throw new Error(`control: packet of ${packet.length} bytes`);
      bytes.push(...packet);
      if (bytes.length > setup.length) throw new Error(`control: ${bytes.length} bytes, asked for ${setup.length}`);
      if (packet.length < this.maxPacket0 || bytes.length === setup.length) break;
      pid ^= 1;
    }
    this.#outPacket(0, 1, [], LIMIT.status, 'status stage');
    return Uint8Array.from(bytes);
  }

  /** A request without data or with data to the device. */
  controlOut(setup, data = []) {
    this.#setup({ ...setup, length: data.length });
    let pid = 1;
    for (let at = 0; at < data.length; at += this.maxPacket0) {
      this.#outPacket(0, pid, data.slice(at, at + this.maxPacket0), LIMIT.data, 'data stage');
      pid ^= 1;
    }
    const status = this.#inPacket(0, 1, LIMIT.status, 'status stage');
    if (status.length !== 0) throw new Error(`control: ${status.length} bytes in the status stage`);
  }

  /** True when the device stalls the request, as it has to with one that it does not know. */
  stalls(setup, data) {
    try {
      if (setup.type & 0x80) this.controlIn(setup);
      else this.controlOut(setup, data);
    } catch (error) {
      if (error instanceof Stall) return true;
      throw error;
    }
    return false;
  }

  /** Sends only a setup packet and leaves the transfer there, as a host that was interrupted. */
  abandon(setup) {
    this.#setup(setup);
  }

  // Bulk ------------------------------------------------------------------------------------------------------------

  /** Reads the endpoint from now on; every packet goes to onPacket(bytes, at). */
  openPipe(endpoint, maxPacket, onPacket) {
    const pipe = new BulkInPipe(this.#board, this, endpoint, maxPacket, onPacket);
    this.pipes.set(endpoint, pipe);
    this.port.onArmed((armed) => this.pipes.get(armed)?.armed());
    pipe.resume();
    return pipe;
  }

  closePipes() {
    for (const pipe of this.pipes.values()) pipe.pause();
    this.pipes.clear();
  }

  /** Sends bytes in packets of 64 with toggles; waits out NAKs up to `limit` nanoseconds a packet. */
  bulkOut(endpoint, bytes, limit = LIMIT.data) {
    for (let at = 0; at < bytes.length; at += 64) {
      const pid = this.#outToggles.get(endpoint) ?? 0;
      this.#outPacket(endpoint, pid, bytes.slice(at, at + 64), limit, 'bulk');
      this.#outToggles.set(endpoint, pid ^ 1);
    }
  }

  /** After CLEAR_FEATURE(ENDPOINT_HALT) and SET_CONFIGURATION toggles start at DATA0. */
  resetOutToggle(endpoint) {
    this.#outToggles.delete(endpoint);
  }

  /** One OUT packet with this toggle, as it is; 'ack', 'nak', 'stall' or 'timeout'. For tests of what is refused. */
  rawOut(endpoint, pid, bytes) {
    const answer = this.port.out(this.address, endpoint, pid, Uint8Array.from(bytes));
    this.#board.run(packetNanos(bytes.length));
    return answer;
  }

  // Packets ---------------------------------------------------------------------------------------------------------

  #setup({ type, code, value, index, length }) {
    const low = (word) => word & 0xff;
    const high = (word) => (word >> 8) & 0xff;
    const bytes = [type, code, low(value), high(value), low(index), high(index), low(length), high(length)];
    const answer = this.port.setup(this.address, Uint8Array.from(bytes));
    this.#board.run(packetNanos(8));
    if (answer !== 'ack') throw new Error(`setup to address ${this.address}: ${answer}`);
  }

  #inPacket(endpoint, pid, limit, what) {
    const end = this.#board.world.now + limit;
    for (;;) {
      const answer = this.attached ? this.port.in(this.address, endpoint) : 'timeout';
      if (answer === 'stall') throw new Stall(`${what}: STALL`);
      if (answer === 'timeout') throw new Error(`${what}: the device does not answer`);
      if (answer !== 'nak') {
        this.#board.run(packetNanos(answer.bytes.length));
        if (answer.pid !== pid) throw new Error(`${what}: DATA${answer.pid} where DATA${pid} is due`);
        return answer.bytes;
      }
      if (this.#board.world.now >= end) throw new Error(`${what}: NAK for ${limit / MILLISECOND} ms`);
      this.#board.run(RETRY_NANOS);
    }
  }

  #outPacket(endpoint, pid, data, limit, what) {
    const end = this.#board.world.now + limit;
    for (;;) {
      const answer = this.attached ? this.port.out(this.address, endpoint, pid, Uint8Array.from(data)) : 'timeout';
      if (answer === 'ack') return this.#board.run(packetNanos(data.length));
      if (answer === 'stall') throw new Stall(`${what}: STALL`);
      if (answer === 'timeout') throw new Error(`${what}: the device does not answer`);
      if (this.#board.world.now >= end) throw new Error(`${what}: NAK for ${limit / MILLISECOND} ms`);
      this.#board.run(RETRY_NANOS);
    }
  }

  // Frames ----------------------------------------------------------------------------------------------------------

  #startFrames() {
    this.#stopFrames();
    const next = () => {
      this.#frame = (this.#frame + 1) & 0x7ff;
      if (this.attached) this.port.startOfFrame(this.#frame);
      this.#frameEvent = this.#board.world.after(MILLISECOND, next);
    };
    this.#frameEvent = this.#board.world.after(MILLISECOND, next);
  }

  #stopFrames() {
    this.#board.world.cancel(this.#frameEvent);
    this.#frameEvent = null;
  }

  #attachmentChanged(attached) {
    this.attachments.push({ at: this.#board.world.now, attached });
    if (attached) return;
    this.#stopFrames();
    this.closePipes();
    this.address = 0;
  }
}
