// Watchdog with its tick generator, which also clocks the timer. Counts down twice a tick (erratum RP2040-E1).
import { Registers } from './registers.mjs';

const TRIGGER = 0x80000000;
const ENABLE = 0x40000000;
const PAUSE = 0x07000000;
const TICK_ENABLE = 1 << 9;
const PSM_PROC0 = 1 << 15;
const PSM_RESETS = 1 << 3;

export class Watchdog extends Registers {
  #clock;
  #alarm;
  #onBite;
  #control = PAUSE;
  #deadlineTicks = 0; // of the tick counter
  #tick = { enabled: false, cycles: 0, since: 0, count: 0 };
  #onTickChange = () => {};

  /** `kept` = { scratch, reason, ticks }: scratch survives every reset but that of the RUN pin. onBite(reason) restarts the chip. */
  constructor(rp2040, clock, kept, onBite) {
    super(rp2040, 'WATCHDOG');
    this.#clock = clock;
    this.#onBite = onBite;
    this.#tick.count = kept.ticks ?? 0;
    this.#alarm = clock.createAlarm(() => this.#bite(1));
    this.reads.set(0x00, () => this.#control | (this.#remaining() & 0xffffff));
    this.writes.set(0x00, (value) => this.#writeControl(value));
    this.writes.set(0x04, (value) => this.#load(value & 0xffffff));
    this.reads.set(0x08, () => kept.reason);
    for (let i = 0; i < 8; i += 1) {
      this.reads.set(0x0c + 4 * i, () => kept.scratch[i]);
      this.writes.set(0x0c + 4 * i, (value) => {
        kept.scratch[i] = value;
      });
    }
    this.reads.set(0x2c, () => (this.#tick.enabled ? (1 << 10) | TICK_ENABLE : 0) | this.#tick.cycles);
    this.writes.set(0x2c, (value) => this.#writeTick(value));
  }

  onTickChange(action) {
    this.#onTickChange = action;
  }

  /** Ticks since the chip started, a real number; the timer's time in microseconds when the tick is 1 MHz. */
  ticks() {
    const { enabled, cycles, since, count } = this.#tick;
    return enabled ? count + (this.#clock.nanos - since) / this.#period(cycles) : count;
  }

  /** Nanoseconds until the tick counter reaches `ticks`; Infinity while it stands. */
  nanosUntil(ticks) {
    return this.#tick.enabled ? Math.max(0, ticks - this.ticks()) * this.#period(this.#tick.cycles) : Infinity;
  }

  get tickHz() {
    return this.#tick.enabled ? 1e9 / this.#period(this.#tick.cycles) : 0;
  }

  get enabled() {
    return (this.#control & ENABLE) !== 0;
  }

  #period(cycles) {
    return ((cycles || 1) / this.rp2040.clocks.refFreq) * 1e9;
  }

  #writeTick(value) {
    const count = this.ticks();
    this.#tick = { enabled: (value & TICK_ENABLE) !== 0, cycles: value & 0x1ff, since: this.#clock.nanos, count };
    this.#onTickChange();
    this.#reschedule();
  }

  #writeControl(value) {
    this.#control = value & (ENABLE | PAUSE);
    if (value & TRIGGER) this.#bite(2);
    else this.#reschedule();
  }

  #load(value) {
    this.#deadlineTicks = this.ticks() + value / 2;
    this.#reschedule();
  }

  #remaining() {
    return Math.max(0, Math.round(2 * (this.#deadlineTicks - this.ticks())));
  }

  #reschedule() {
    this.#alarm.cancel();
    const wait = this.enabled ? this.nanosUntil(this.#deadlineTicks) : Infinity;
    if (wait !== Infinity) this.#alarm.schedule(wait);
  }

  #bite(reason) {
    const selected = this.rp2040.peripherals[0x40010].readUint32(0x8);
    if ((selected & PSM_PROC0) && (selected & PSM_RESETS)) this.#onBite(reason);
    else this.error(`expired, but PSM.WDSEL 0x${selected.toString(16)} does not restart the processor and RESETS`);
  }
}
