// A USB device in a few lines behind the interface of the emulated controller, so that the host's own checks can be tested:
// `flaw` makes it break one rule. Not a test.
import { Faults } from '../chip/faults.mjs';
import { World } from '../chip/world.mjs';

const DEVICE = [18, 1, 0, 2, 0xef, 2, 1, 64, 0x09, 0x12, 1, 0, 0x10, 0, 1, 2, 3, 1];
export const CONFIGURATION = [
  9, 2, 84, 0, 3, 1, 0, 0x80, 50, 8, 11, 0, 2, 2, 2, 0, 0, 9, 4, 0, 0, 1, 2, 2, 0, 0, 5, 0x24, 0, 0x20, 1, 5, 0x24, 1, 0, 1,
  4, 0x24, 2, 2, 5, 0x24, 6, 0, 1, 7, 5, 0x81, 3, 8, 0, 16, 9, 4, 1, 0, 2, 10, 0, 0, 0, 7, 5, 2, 2, 64, 0, 0,
  7, 5, 0x82, 2, 64, 0, 0, 9, 4, 2, 0, 0, 255, 0, 1, 0,
];
export const DEVICE_DESCRIPTOR = Uint8Array.from(DEVICE);

export class FakeDevice {
  attached = true;
  address = 0;
  flaw = null;
  stream = []; // packets for endpoint 2 IN
  #reply = [];
  #pid = 1;
  #newAddress = null;
  #configuration = 0;
  #streamPid = 0;

  beginBusReset() {
    this.address = 0;
  }

  endBusReset() {}
  startOfFrame() {}
  onArmed() {}

  setup(address, bytes) {
    if (address !== this.address && this.flaw !== 'deaf to addresses') return 'timeout';
    const [type, code, value, kind] = bytes;
    this.#pid = this.flaw === 'data stage starts with DATA0' ? 0 : 1;
    this.#reply = [[]];
    const length = bytes[6] | (bytes[7] << 8);
    if (type === 0x80 && code === 6) this.#reply = this.#packets(this.#descriptor(kind, value), length);
    if (type === 0x80 && code === 8) this.#reply = [[this.#configuration]];
    if (type === 0 && code === 5) this.#newAddress = value;
    if (type === 0 && code === 9) this.#configuration = value;
    return 'ack';
  }

  in(address, endpoint) {
    if (address !== this.address) return 'timeout';
    if (endpoint === 2) return this.#streamPacket();
    if (this.flaw === 'never ready') return 'nak';
    if (!this.#reply || this.#reply.length === 0) return 'stall';
    const bytes = Uint8Array.from(this.#reply.shift());
    const pid = this.#pid;
    if (this.flaw !== 'toggle stands still') this.#pid ^= 1;
    if (this.#newAddress !== null && bytes.length === 0) {
      this.address = this.#newAddress;
      this.#newAddress = null;
    }
    return { pid, bytes };
  }

  out() {
    return this.flaw === 'refuses the status stage' ? 'stall' : 'ack';
  }

  #descriptor(kind, index) {
    if (kind === 1) return DEVICE;
    if (kind === 2) return CONFIGURATION;
    const text = index === 0 ? [9, 4] : [...'slamd'].flatMap((letter) => [letter.charCodeAt(0), 0]);
    return [text.length + 2, 3, ...text];
  }

  #packets(bytes, length) {
    const answer = this.flaw === 'more than asked for' ? bytes : bytes.slice(0, length);
    const packets = [];
    for (let at = 0; at < answer.length; at += 64) packets.push(answer.slice(at, at + 64));
    if (answer.length % 64 === 0 && answer.length < length) packets.push([]);
    return packets;
  }

  #streamPacket() {
    if (this.stream.length === 0) return 'nak';
    const pid = this.#streamPid;
    if (this.flaw !== 'stream toggle stands still') this.#streamPid ^= 1;
    return { pid, bytes: Uint8Array.from(this.stream.shift()) };
  }
}

/** What UsbHost wants of a board. */
export function fakeBoard(device) {
  const world = new World();
  return {
    world, faults: new Faults(world), chip: { usb: device }, running: true,
    onAttach: () => {},
    run: (nanos) => world.advanceTo(world.now + nanos),
    runUntil(done, nanos) {
      const end = world.now + nanos;
      while (!done() && world.now < end) world.advanceTo(Math.min(end, world.nextAt));
      return done();
    },
  };
}
