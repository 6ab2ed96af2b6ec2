// The 64-bit microsecond timer with four alarms, clocked by the watchdog's tick generator (which has to be started).
import { IRQ_TIMER_0 } from './interrupts.mjs';
import { Registers } from './registers.mjs';

export class Timer extends Registers {
  #watchdog;
  #latchedHigh = 0;
  #raw = 0;
  #enabled = 0;
  #forced = 0;
  #armed = 0;
  #targets = [0, 0, 0, 0];
  #alarms;

  constructor(rp2040, clock, watchdog) {
    super(rp2040, 'TIMER');
    this.#watchdog = watchdog;
    this.#alarms = [0, 1, 2, 3].map((i) => clock.createAlarm(() => this.#fire(i)));
    watchdog.onTickChange(() => this.#targets.forEach((_, i) => this.#schedule(i)));
    this.reads.set(0x08, () => this.#latchedHigh);
    this.reads.set(0x0c, () => this.#readLow());
    this.reads.set(0x24, () => this.#high());
    this.reads.set(0x28, () => this.#low());
    this.#targets.forEach((_, i) => {
      this.reads.set(0x10 + 4 * i, () => this.#targets[i]);
      this.writes.set(0x10 + 4 * i, (value) => this.#arm(i, value));
    });
    this.reads.set(0x20, () => this.#armed);
    this.writes.set(0x20, (_, raw) => this.#disarm(raw));
    this.keep(0x2c, 3, 7);
    this.reads.set(0x34, () => this.#raw);
    this.writes.set(0x34, (_, raw) => this.#update(() => (this.#raw &= ~raw)));
    this.reads.set(0x38, () => this.#enabled);
    this.writes.set(0x38, (value) => this.#update(() => (this.#enabled = value & 15)));
    this.reads.set(0x3c, () => this.#forced);
    this.writes.set(0x3c, (value) => this.#update(() => (this.#forced = value & 15)));
    this.reads.set(0x40, () => this.#status());
  }

  get micros() {
    return Math.floor(this.#watchdog.ticks() + 1e-6);
  }

  #low() {
    return this.micros % 2 ** 32;
  }

  #high() {
    return Math.floor(this.micros / 2 ** 32);
  }

  #readLow() {
    this.#latchedHigh = this.#high();
    return this.#low();
  }

  #status() {
    return (this.#raw & this.#enabled) | this.#forced;
  }

  #update(change) {
    change();
    for (let i = 0; i < 4; i += 1) this.rp2040.setInterrupt(IRQ_TIMER_0 + i, (this.#status() & (1 << i)) !== 0);
  }

  #arm(i, value) {
    this.#targets[i] = value >>> 0;
    this.#armed |= 1 << i;
    this.#schedule(i);
  }

  #schedule(i) {
    this.#alarms[i].cancel();
    if (!(this.#armed & (1 << i))) return;
    const delta = (this.#targets[i] - this.#low()) >>> 0;
    const wait = this.#watchdog.nanosUntil(this.micros + delta);
    if (wait !== Infinity) this.#alarms[i].schedule(wait);
  }

  #disarm(mask) {
    this.#armed &= ~mask;
    this.#targets.forEach((_, i) => this.#schedule(i));
  }

  #fire(i) {
    this.#armed &= ~(1 << i);
    this.#update(() => (this.#raw |= 1 << i));
  }
}
