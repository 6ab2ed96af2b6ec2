// The USB controller in device mode (RP2040 data sheet 4.1), transaction by transaction, so that a host can see toggles,
// NAKs, stalls and addresses. Buffers are handed over by AVAILABLE and given back by BUFF_STATUS. Host mode is not here.
import { IRQ_USBCTRL } from './interrupts.mjs';
import { Registers } from './registers.mjs';
import { EndpointBuffers } from './usb_buffers.mjs';

export const SIE = {
  vbus: 1 << 0, suspended: 1 << 4, resume: 1 << 11, connected: 1 << 16, setup: 1 << 17, complete: 1 << 18,
  busReset: 1 << 19, sequenceError: 0x80000000,
};
const WRITE_CLEAR = 0xff0f0000 | SIE.resume | SIE.suspended;
const INT = { busReset: 1 << 12, connected: 1 << 13, suspend: 1 << 14, resume: 1 << 15, setup: 1 << 16, sof: 1 << 17, buffer: 1 << 4,
  vbus: 1 << 11, sequenceError: 1 << 5 };
const LINE_J = 1 << 2;
const PULLUP = 1 << 16;
const EP0_INTERRUPT = 1 << 29;
const MUX_PHY = 1;
const MUX_PADS = 4;
const SOFTCON = 8;
const RESET_EXIT_NANOS = 800e3; // erratum RP2040-E5: idle time after a bus reset before the device is connected

export class UsbController extends Registers {
  #clock;
  #connectAlarm;
  #buffers;
  #onArmed = () => {};
  #onPullUp = () => {};
  #busyBus = false;
  #watching = false; // for the idle time that ends a bus reset
  #wasAttached = false;

  constructor(rp2040, clock, faults) {
    super(rp2040, 'USB');
    this.#clock = clock;
    this.#connectAlarm = clock.createAlarm(() => this.#connect());
    this.#buffers = new EndpointBuffers(rp2040, clock, faults, (endpoint) => this.#onArmed(endpoint));
    this.reset();
    this.#mapRegisters();
  }

  /** As after RESETS. */
  reset() {
    this.#connectAlarm.cancel();
    this.#watching = false;
    this.#wasAttached = false;
    Object.assign(this, { address: 0, mainCtrl: 0, sieCtrl: 0x8000, sieStatus: 0, buffStatus: 0, stallArm: 0, muxing: 0, power: 0 });
    Object.assign(this, { intEnable: 0, intForce: 0, frame: 0, sofPending: false, inReset: false });
    this.#update();
    this.#onPullUp(false);
  }

  onArmed(action) {
    this.#onArmed = action;
  }

  /** Calls action(attached) when the device shows itself on the bus or leaves it. */
  onPullUp(action) {
    this.#onPullUp = action;
  }

  get buffers() {
    return this.#buffers;
  }

  // The bus side ----------------------------------------------------------------------------------------------------

  /** The device holds D+ up: a host sees it. */
  get attached() {
    const powered = (this.sieStatus & SIE.vbus) !== 0 && (this.muxing & SOFTCON) !== 0;
    return powered && (this.mainCtrl & 1) !== 0 && (this.sieCtrl & PULLUP) !== 0;
  }

  /** Single-ended zero for as long as a reset takes; busyBus: other traffic leaves no idle time after it. */
  beginBusReset(busyBus) {
    this.#busyBus = busyBus;
    this.inReset = true;
    this.#watchForIdle();
    this.sieStatus &= ~(SIE.connected | SIE.suspended | LINE_J);
    this.sieStatus |= SIE.busReset;
    this.#update();
  }

  endBusReset() {
    this.inReset = false;
    this.sieStatus |= LINE_J;
    this.#watchForIdle();
  }

  startOfFrame(number) {
    if (!this.#hears(this.address)) return;
    this.frame = number;
    this.sofPending = true;
    this.#update();
  }

  suspend() {
    if (this.attached) this.#raiseStatus(SIE.suspended);
  }

  resume() {
    this.sieStatus &= ~SIE.suspended;
    if (this.attached) this.#raiseStatus(SIE.resume);
  }

  /** Returns 'ack' or 'timeout'. */
  setup(address, bytes) {
    if (!this.#hears(address)) return 'timeout';
    this.rp2040.usbDPRAM.set(bytes, 0);
    this.stallArm = 0;
    this.#raiseStatus(SIE.setup);
    return 'ack';
  }

  /** IN token. Returns { pid, bytes }, 'nak', 'stall' or 'timeout'. */
  in(address, endpoint) {
    if (!this.#hears(address)) return 'timeout';
    if (endpoint === 0 && this.sieStatus & SIE.setup) return 'nak';
    const result = this.#buffers.take(endpoint, (this.stallArm & 1) !== 0);
    if (typeof result === 'object') this.#finish(endpoint, 0);
    return result;
  }

  /** OUT token with data. Returns 'ack', 'nak', 'stall' or 'timeout'. */
  out(address, endpoint, pid, bytes) {
    if (!this.#hears(address)) return 'timeout';
    if (endpoint === 0 && this.sieStatus & SIE.setup) return 'nak';
    const result = this.#buffers.give(endpoint, pid, bytes, (this.stallArm & 2) !== 0);
    if (result === 'sequence') this.#raiseStatus(SIE.sequenceError);
    else if (result === 'ack') this.#finish(endpoint, 1);
    return result === 'sequence' ? 'ack' : result;
  }

  // The processor's side --------------------------------------------------------------------------------------------

  /** rp2040js calls this after a write to the dual-port RAM. */
  DPRAMUpdated(offset, value) {
    this.#buffers.written(offset, value >>> 0);
  }

  #mapRegisters() {
    this.#field(0x00, 'address', 0x7f);
    this.#field(0x40, 'mainCtrl', 3);
    this.reads.set(0x48, () => this.#readFrame());
    this.#field(0x4c, 'sieCtrl', 0xffffffff);
    this.reads.set(0x50, () => this.sieStatus);
    this.writes.set(0x50, (_, raw) => this.#clearStatus(raw & WRITE_CLEAR));
    this.reads.set(0x58, () => this.buffStatus);
    this.writes.set(0x58, (_, raw) => {
      this.buffStatus &= ~raw;
    });
    this.keep(0x60);
    this.reads.set(0x64, () => 0xffffffff);
    this.writes.set(0x64, () => {});
    this.#field(0x68, 'stallArm', 3);
    this.reads.set(0x70, () => 0);
    this.writes.set(0x70, () => {});
    this.#field(0x74, 'muxing', 15);
    this.#field(0x78, 'power', 0x3f);
    for (const offset of [0x7c, 0x80, 0x84]) this.keep(offset);
    this.reads.set(0x8c, () => this.#pending());
    this.#field(0x90, 'intEnable', 0xfffff);
    this.#field(0x94, 'intForce', 0xfffff);
    this.reads.set(0x98, () => (this.#pending() & this.intEnable) | this.intForce);
    for (const [offset, write] of this.writes) {
      this.writes.set(offset, (value, raw) => {
        write(value, raw);
        this.#changed();
      });
    }
  }

  #field(offset, name, mask) {
    this.reads.set(offset, () => this[name]);
    this.writes.set(offset, (value) => {
      this[name] = (value & mask) >>> 0;
    });
  }

  #changed() {
    const detect = (this.power & 0xc) === 0xc; // VBUS_DETECT with its override: the board does not wire VBUS to the chip
    this.sieStatus = detect ? this.sieStatus | SIE.vbus : this.sieStatus & ~SIE.vbus;
    if (this.attached !== this.#wasAttached) {
      this.#wasAttached = this.attached;
      this.sieStatus = this.attached ? this.sieStatus | LINE_J : this.sieStatus & ~LINE_J;
      this.#onPullUp(this.attached);
    }
    if (this.sieStatus & LINE_J && !(this.sieStatus & SIE.connected)) this.#watchForIdle();
    this.#update();
  }

  #hears(address) {
    const connected = this.attached && (this.sieStatus & SIE.connected) !== 0 && (this.muxing & MUX_PHY) !== 0;
    return connected && !this.inReset && address === this.address && this.#clocked();
  }

  #clocked() {
    const { usbCtrl, usbDiv } = this.rp2040.clocks;
    const running = (usbCtrl & (1 << 11)) !== 0 && ((usbCtrl >> 5) & 7) === 0 && usbDiv === 0x100;
    return running && this.rp2040.pllUsb.frequency === 48e6;
  }

  #forcedIdle() {
    return (this.muxing & MUX_PADS) !== 0 && (this.muxing & MUX_PHY) === 0;
  }

  #watchForIdle() {
    const idle = !this.inReset && this.attached && (!this.#busyBus || this.#forcedIdle());
    if (idle === this.#watching) return;
    this.#watching = idle;
    if (idle) this.#connectAlarm.schedule(RESET_EXIT_NANOS);
    else this.#connectAlarm.cancel();
  }

  #connect() {
    this.#watching = false;
    this.#raiseStatus(SIE.connected);
  }

  #finish(endpoint, out) {
    const interrupts = endpoint === 0 ? (this.sieCtrl & EP0_INTERRUPT) !== 0 : this.#buffers.interrupts(endpoint, out);
    if (interrupts) this.buffStatus |= 1 << (2 * endpoint + out);
    this.sieStatus |= SIE.complete;
    this.#update();
  }

  #raiseStatus(bits) {
    this.sieStatus |= bits;
    this.#update();
  }

  #clearStatus(bits) {
    this.sieStatus &= ~bits;
  }

  #readFrame() {
    this.sofPending = false;
    this.#update();
    return this.frame;
  }

  #pending() {
    const { sieStatus } = this;
    const map = [[SIE.busReset, INT.busReset], [SIE.connected, INT.connected], [SIE.suspended, INT.suspend],
      [SIE.resume, INT.resume], [SIE.setup, INT.setup], [SIE.sequenceError, INT.sequenceError]];
    let pending = (this.buffStatus ? INT.buffer : 0) | (this.sofPending ? INT.sof : 0);
    for (const [status, interrupt] of map) if (sieStatus & status) pending |= interrupt;
    return pending;
  }

  #update() {
    this.rp2040.setInterrupt(IRQ_USBCTRL, ((this.#pending() & this.intEnable) | this.intForce) !== 0);
  }
}
