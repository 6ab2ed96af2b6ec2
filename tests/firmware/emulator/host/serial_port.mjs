// The board as a program on the host has it: an open serial port whose bytes are read into packets, and commands to it.
import { MILLISECOND, SECOND } from '../board/board.mjs';
import { enumerate } from './enumeration.mjs';
import { command, PacketReader } from './packets.mjs';
import { request, UsbHost } from './usb_host.mjs';

const TO_INTERFACE = 0x21;
const SET_LINE_CODING = 0x20;
const SET_LINE_STATE = 0x22;

export const COMMAND = { identity: 1, statistics: 2, selfTest: 3, reset: 4, bootLoader: 5 };

export class SerialPort {
  reader = new PacketReader();
  pipe = null;
  #board;
  #tag = 100;

  constructor(board) {
    this.#board = board;
    this.host = new UsbHost(board);
  }

  /** Plugs in: enumeration, then open() unless told otherwise. */
  plugIn({ open = true, ...options } = {}) {
    this.read = enumerate(this.#board, this.host, options);
    const data = this.read.configuration.interfaces.find((one) => one.class[0] === 10);
    this.inEndpoint = data.endpoints.find((endpoint) => endpoint.address & 0x80).address & 15;
    this.outEndpoint = data.endpoints.find((endpoint) => !(endpoint.address & 0x80)).address;
    if (open) this.open();
    return this;
  }

  open() {
    this.setLineState(3);
    this.startReading();
  }

  close() {
    this.pipe.pause();
    this.setLineState(0);
  }

  startReading() {
    const { host } = this;
    if (host.pipes.has(this.inEndpoint)) host.pipes.get(this.inEndpoint).resume();
    else this.pipe = host.openPipe(this.inEndpoint, 64, (bytes, at) => this.reader.push(bytes, at));
  }

  /** As a program that no longer reads: the host's buffers are full, the device gets NAK-less silence. */
  stopReading() {
    this.pipe.pause();
  }

  setLineCoding(baud) {
    const coding = [baud & 0xff, (baud >> 8) & 0xff, (baud >> 16) & 0xff, baud >>> 24, 0, 0, 8];
    this.host.controlOut(request(TO_INTERFACE, SET_LINE_CODING, 0, 0), coding);
  }

  setLineState(bits) {
    this.host.controlOut(request(TO_INTERFACE, SET_LINE_STATE, bits, 0));
  }

  /** Sends a command and waits for the packet with its tag; undefined when none comes within `nanos`. */
  ask(code, nanos = 2 * SECOND) {
    this.#tag += 1;
    const tag = this.#tag;
    this.host.bulkOut(this.outEndpoint, command(code, tag));
    const answer = () => this.reader.packets.find((packet) => packet.tag === tag && packet.kind !== 'sample');
    this.#board.runUntil(() => answer() !== undefined, nanos);
    return answer();
  }

  /** Runs until a packet fulfils `wanted`; undefined after `nanos`. Only packets that arrive from now on. */
  waitFor(wanted, nanos = 5 * SECOND) {
    const { reader } = this;
    let next = reader.packets.length;
    let found;
    const look = () => {
      for (; next < reader.packets.length && !found; next += 1) if (wanted(reader.packets[next])) found = reader.packets[next];
      return found !== undefined;
    };
    this.#board.runUntil(look, nanos);
    return found;
  }

  /** Runs for `nanos` and returns the samples that came in that time. */
  collect(nanos) {
    const from = this.reader.packets.length;
    this.#board.run(nanos);
    return this.reader.packets.slice(from).filter((packet) => packet.kind === 'sample');
  }
}

export { MILLISECOND, SECOND };
