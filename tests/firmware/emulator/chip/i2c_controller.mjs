// I2C0 as master (DW_apb_i2c, RP2040 data sheet 4.3): interrupts by level, times on the bus, aborts, a bus that hangs.
import { IRQ_I2C0 } from './interrupts.mjs';
import { Registers } from './registers.mjs';

const FIFO_DEPTH = 16;
const RAW = { rxUnder: 1, rxOver: 2, rxFull: 4, txOver: 8, txEmpty: 16, txAbort: 64, activity: 256, stop: 512, start: 1024 };
const ABORT = { addressNack: 1, dataNack: 1 << 3, user: 1 << 16, arbitration: 1 << 12 };
const READ = 1 << 8;
const STOP = 1 << 9;
const RESTART = 1 << 10;
const FAST_MIN = { highNanos: 600, lowNanos: 1300 }; // UM10204, table 10

/** `bus`: start(address, isRead) -> ack, write(byte) -> ack, read() -> byte, stop(), sdaHeld, connected, onFree(action). */
export class I2cController extends Registers {
  #bus;
  #alarm;
  #config;
  #enable;
  #mask;
  #raw;
  #abortSource;
  #tx;
  #rx;
  #phase; // 'idle', 'waiting' for a free bus, 'byte' on the wire, 'held' between bytes
  #direction; // of the transfer under way: true = read, null = none
  #acknowledged = true;
  transfers = 0; // since power-on

  constructor(rp2040, clock, bus) {
    super(rp2040, 'I2C0');
    this.#bus = bus;
    this.#alarm = clock.createAlarm(() => this.#byteDone());
    bus.onFree(() => this.#phase === 'waiting' && this.#next());
    this.reset();
    this.#mapConfiguration();
    this.#mapInterrupts();
    this.reads.set(0x10, () => this.#pull());
    this.writes.set(0x10, (value) => this.#push(value));
    this.reads.set(0x6c, () => this.#enable);
    this.writes.set(0x6c, (value) => this.#writeEnable(value));
    this.reads.set(0x70, () => this.#status());
    this.reads.set(0x74, () => this.#tx.length);
    this.reads.set(0x78, () => this.#rx.length);
    this.reads.set(0x80, () => this.#abortSource);
    this.reads.set(0x9c, () => this.#enable & 1);
  }

  /** As after RESETS. */
  reset() {
    this.#alarm.cancel();
    this.#config = new Map([
      [0x00, 0x65], [0x04, 0x55], [0x08, 0x55], [0x14, 0x28], [0x18, 0x2f], [0x1c, 6], [0x20, 13], [0x38, 0], [0x3c, 0],
      [0x7c, 1], [0x88, 0], [0x94, 0x64], [0xa0, 7],
    ]);
    this.#enable = 0;
    this.#mask = 0x8ff;
    this.#raw = 0;
    this.#abortSource = 0;
    this.#tx = [];
    this.#rx = [];
    this.#phase = 'idle';
    this.#direction = null;
    this.#update();
  }

  /** One SCL period, nanoseconds (data sheet 4.3.14.1). */
  bitTimes() {
    const fast = ((this.#config.get(0x00) >> 1) & 3) !== 1;
    const cycle = 1e9 / this.rp2040.clkSys;
    const highNanos = (this.#config.get(fast ? 0x1c : 0x14) + this.#config.get(0xa0) + 7) * cycle;
    const lowNanos = (this.#config.get(fast ? 0x20 : 0x18) + 1) * cycle;
    return { highNanos, lowNanos, period: highNanos + lowNanos };
  }

  #mapConfiguration() {
    const whileEnabled = new Set([0x38, 0x3c, 0x88]);
    for (const offset of this.#config.keys()) {
      this.reads.set(offset, () => this.#config.get(offset));
      this.writes.set(offset, (value) => {
        if (this.#enable & 1 && !whileEnabled.has(offset)) this.error(`0x${offset.toString(16)} written while enabled`);
        this.#config.set(offset, value & 0xffff);
        this.#update();
      });
    }
  }

  #mapInterrupts() {
    this.reads.set(0x2c, () => this.#pending() & this.#mask);
    this.reads.set(0x30, () => this.#mask);
    this.writes.set(0x30, (value) => {
      this.#mask = value & 0x1fff;
      this.#update();
    });
    this.reads.set(0x34, () => this.#pending());
    const all = RAW.rxUnder | RAW.rxOver | RAW.txOver | RAW.txAbort | RAW.activity | RAW.stop | RAW.start;
    const clears = [[0x40, all], [0x44, RAW.rxUnder], [0x48, RAW.rxOver], [0x4c, RAW.txOver], [0x54, RAW.txAbort],
      [0x5c, RAW.activity], [0x60, RAW.stop], [0x64, RAW.start]];
    for (const [offset, bits] of clears) this.reads.set(offset, () => this.#clear(bits));
  }

  #pending() {
    const on = this.#enable & 1;
    const empty = on && this.#tx.length <= this.#config.get(0x3c) ? RAW.txEmpty : 0;
    const full = on && this.#rx.length > this.#config.get(0x38) ? RAW.rxFull : 0;
    return this.#raw | empty | full;
  }

  #update() {
    this.rp2040.setInterrupt(IRQ_I2C0, (this.#pending() & this.#mask) !== 0);
  }

  #raise(bits) {
    this.#raw |= bits;
    this.#update();
  }

  #clear(bits) {
    const was = this.#raw & bits;
    this.#raw &= ~bits;
    if (bits & RAW.txAbort) this.#abortSource = 0;
    this.#update();
    return was ? 1 : 0;
  }

  #status() {
    const active = this.#phase === 'byte' || this.#phase === 'held' ? 0x21 : 0;
    const tx = (this.#tx.length === 0 ? 4 : 0) | (this.#tx.length < FIFO_DEPTH ? 2 : 0);
    return active | tx | (this.#rx.length ? 8 : 0) | (this.#rx.length === FIFO_DEPTH ? 16 : 0);
  }

  #pull() {
    if (this.#rx.length === 0) this.#raise(RAW.rxUnder);
    const value = this.#rx.shift() ?? 0;
    this.#update();
    return value;
  }

  #push(value) {
    if (!(this.#enable & 1)) return this.error('command while disabled');
    if (this.#raw & RAW.txAbort) return undefined; // the FIFO is held empty until the abort is cleared
    if (this.#tx.length === FIFO_DEPTH) return this.#raise(RAW.txOver);
    this.#tx.push(value & 0x7ff);
    if (this.#phase === 'idle' || this.#phase === 'held') this.#next();
    this.#update();
    return undefined;
  }

  #writeEnable(value) {
    const was = this.#enable & 1;
    this.#enable = value & 7;
    if (this.#enable & 1 && !was) this.#checkTimes();
    if (!(this.#enable & 1) && was) this.#disable();
    if (this.#enable & 2) this.#abortByUser();
    this.#update();
  }

  #checkTimes() {
    const { highNanos, lowNanos } = this.bitTimes();
    if (highNanos < FAST_MIN.highNanos) this.error(`SCL high ${highNanos.toFixed(0)} ns`);
    if (lowNanos < FAST_MIN.lowNanos) this.error(`SCL low ${lowNanos.toFixed(0)} ns`);
  }

  #disable() {
    this.#alarm.cancel();
    if (this.#phase === 'byte' || this.#phase === 'held') this.#bus.stop();
    this.#tx = [];
    this.#rx = [];
    this.#raw = 0;
    this.#endTransfer();
  }

  #abortByUser() {
    if (this.#phase === 'waiting') return; // never ends while the bus hangs
    if (this.#phase === 'idle') this.#enable &= ~2;
    else this.#abort(ABORT.user);
  }

  #abort(source) {
    this.#alarm.cancel();
    this.#tx = [];
    this.#abortSource |= source;
    this.#enable &= ~2;
    this.#raise(RAW.txAbort);
    if (source !== ABORT.arbitration) this.#stop();
    else this.#endTransfer();
  }

  #endTransfer() {
    this.#phase = 'idle';
    this.#direction = null;
  }

  #stop() {
    this.#bus.stop();
    this.#endTransfer();
    this.#raise(RAW.stop);
  }

  /** Puts the next command on the wire, if there is one and the bus allows. */
  #next() {
    if (this.#tx.length === 0) {
      if (this.#phase !== 'idle') this.#phase = this.#direction === null ? 'idle' : 'held';
      return;
    }
    if (this.#direction === null && (this.#bus.sdaHeld || !this.#bus.connected)) {
      this.#phase = 'waiting';
      return;
    }
    const isRead = (this.#tx[0] & READ) !== 0;
    this.#phase = 'byte';
    if (this.#direction !== isRead || this.#tx[0] & RESTART) this.#sendAddress(isRead);
    else this.#alarm.schedule(9 * this.bitTimes().period);
  }

  #sendAddress(isRead) {
    this.transfers += this.#direction === null ? 1 : 0;
    this.#raise(RAW.start | RAW.activity);
    this.#direction = isRead;
    this.#tx[0] &= ~RESTART;
    const { period } = this.bitTimes();
    const ack = this.#bus.start(this.#config.get(0x04) & 0x3ff, isRead);
    this.#acknowledged = ack;
    this.#alarm.schedule(ack ? 19 * period : 10 * period);
  }

  #byteDone() {
    if (!this.#acknowledged) {
      this.#acknowledged = true;
      this.#abort(ABORT.addressNack);
      return;
    }
    const command = this.#tx.shift();
    if (command & READ) this.#receive(this.#bus.read());
    else if (this.#bus.sdaHeld) return void this.#abort(ABORT.arbitration);
    else if (!this.#bus.write(command & 0xff)) return void this.#abort(ABORT.dataNack);
    if (this.#bus.sdaHeld && command & STOP) return void (this.#phase = 'waiting'); // the stop condition cannot be made
    if (command & STOP) this.#stop();
    this.#next();
    this.#update();
  }

  #receive(byte) {
    if (this.#rx.length === FIFO_DEPTH) this.#raise(RAW.rxOver);
    else this.#rx.push(byte);
    this.#update();
  }
}
