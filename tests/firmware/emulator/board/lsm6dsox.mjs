// Register model of the LSM6DSOX inertial sensor (data sheet DS12814): configuration, output registers, data-ready,
// self-test, and the ways in which it fails. It measures what `motion` says; noise and filters are the motion's business.

export const SENSOR_ADDRESS = 0x6a;
const WHO_AM_I = 0x6c;
const GRAVITY = 9.80665;
const BOOT_NANOS = 10e6; // 10 ms, chapter 4
const RESET_NANOS = 50e3;
const PULSE_NANOS = 75e3; // of data-ready in pulsed mode
const RATES_HZ = [0, 12.5, 26, 52, 104, 208, 416, 833, 1667, 3333, 6667];
const ACCEL_MG = [0.061, 0.488, 0.122, 0.244]; // by FS_XL: +-2, 16, 4, 8 g
const GYRO_MDPS = [8.75, 17.5, 35, 70]; // by FS_G: 250, 500, 1000, 2000 dps
const SELF_TEST = { accelMg: 700, gyroDps: 400 }; // within 50..1700 mg and 150..700 dps (at 2000 dps), table 3
const REGISTERS = new Set([
  0x01, 0x02, 0x04, 0x07, 0x08, 0x09, 0x0a, 0x0b, 0x0c, 0x0d, 0x0e, 0x0f, 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18, 0x19,
  0x1a, 0x1b, 0x1c, 0x1d, 0x1e,
]);
const DEFAULTS = { 0x0f: WHO_AM_I, 0x12: 0x04, 0x18: 0xe0, 0x02: 0x3f };

/** At rest, level: gravity on z. `motion(seconds)` gives { gyro: rad/s x3, accel: m/s^2 x3, temperature: degC }. */
export const atRest = () => ({ gyro: [0, 0, 0], accel: [0, 0, GRAVITY], temperature: 25 });

export class Lsm6dsox {
  address = SENSOR_ADDRESS;
  motion = atRest;
  rateError = 0; // of its oscillator, relative
  samples = []; // { at (ns), gyro, accel: counts, temperature }: what it measured, for the tests to compare
  keepSamples = true;
  whoAmI = WHO_AM_I;
  selfTestWorks = true;
  dataReadyWorks = true;

  #world;
  #registers = new Uint8Array(0x80);
  #bytes = new Uint8Array(14);
  #fresh = { gyro: false, accel: false };
  #pointer = null; // register address of the transfer; null = the next byte written is it
  #readyAt = 0;
  #sampleEvent = null;
  #pin = false;
  #powered = true;
  #onPin = () => {};
  #onSda = () => {};
  #hold = 0; // clock pulses until SDA is let go; 0 = not held
  #blocked = new Map(); // with BDU: high byte kept until it is read

  constructor(world) {
    this.#world = world;
    this.powerOn();
  }

  get holdsSda() {
    return this.#hold > 0;
  }

  get dataReady() {
    return this.#pin;
  }

  register(address) {
    return this.#registers[address];
  }

  onDataReady(action) {
    this.#onPin = action;
  }

  onSda(action) {
    this.#onSda = action;
  }

  powerOn() {
    this.#powered = true;
    this.#restore(BOOT_NANOS);
  }

  /** As if it were not there: no acknowledge, no data-ready. */
  powerOff() {
    this.#restore(0);
    this.#powered = false;
  }

  /** Holds SDA low, as after an interrupted read, until SCL was pulsed `pulses` times (Infinity: until release()). */
  hang(pulses) {
    this.#hold = pulses;
    this.#onSda();
  }

  release() {
    this.#hold = 0;
    this.#onSda();
  }

  // Bus -------------------------------------------------------------------------------------------------------------

  clockPulse() {
    if (this.#hold > 0) {
      this.#hold -= 1;
      if (this.#hold === 0) this.#onSda();
    }
  }

  start(isRead) {
    if (!this.#powered || this.#world.now < this.#readyAt || this.holdsSda) return false;
    if (!isRead) this.#pointer = null;
    return true;
  }

  stop() {}

  write(byte) {
    if (this.#pointer === null) {
      this.#pointer = byte & 0x7f;
      return true;
    }
    this.#writeRegister(this.#pointer, byte);
    this.#advance();
    return true;
  }

  read() {
    const value = this.#readRegister(this.#pointer ?? 0);
    this.#advance();
    return value;
  }

  #advance() {
    if (this.#registers[0x12] & 4) this.#pointer = (this.#pointer + 1) & 0x7f; // IF_INC
  }

  // Registers -------------------------------------------------------------------------------------------------------

  #restore(unreadyNanos) {
    this.#registers.fill(0);
    for (const [address, value] of Object.entries(DEFAULTS)) this.#registers[address] = value;
    this.#bytes.fill(0);
    this.#fresh = { gyro: false, accel: false };
    this.#blocked.clear();
    this.#readyAt = this.#world.now + unreadyNanos;
    this.#reschedule();
    this.#updatePin();
  }

  #writeRegister(address, value) {
    if (address === 0x0f || address === 0x1e || !REGISTERS.has(address)) return;
    const rates = [this.#registers[0x10] >> 4, this.#registers[0x11] >> 4];
    if (address === 0x12 && value & 0x81) return void this.#restore(value & 0x80 ? BOOT_NANOS : RESET_NANOS);
    this.#registers[address] = value;
    const changed = rates[0] !== this.#registers[0x10] >> 4 || rates[1] !== this.#registers[0x11] >> 4;
    if (changed) this.#reschedule();
    this.#updatePin();
  }

  #readRegister(address) {
    if (address === 0x0f) return this.whoAmI;
    if (address === 0x1e) return (this.#fresh.gyro ? 6 : 0) | (this.#fresh.accel ? 1 : 0);
    if (address >= 0x20 && address <= 0x2d) return this.#readOutput(address - 0x20);
    return this.#registers[address];
  }

  #readOutput(at) {
    const high = at | 1;
    let value = this.#bytes[at];
    if (this.#registers[0x12] & 0x40) {
      if (at !== high && !this.#blocked.has(high)) this.#blocked.set(high, this.#bytes[high]);
      else if (at === high) {
        value = this.#blocked.get(high) ?? value;
        this.#blocked.delete(high);
      }
    }
    if (at === 13) this.#fresh.accel = false;
    if (at === 7) this.#fresh.gyro = false;
    this.#updatePin();
    return value;
  }

  // Measuring -------------------------------------------------------------------------------------------------------

  #rate() {
    const gyro = RATES_HZ[this.#registers[0x11] >> 4] ?? 0;
    return gyro || (RATES_HZ[this.#registers[0x10] >> 4] ?? 0);
  }

  #reschedule() {
    this.#world.cancel(this.#sampleEvent);
    this.#sampleEvent = null;
    const rate = this.#rate();
    if (rate) this.#sampleEvent = this.#world.after(1e9 / (rate * (1 + this.rateError)), () => this.#sample());
  }

  #sample() {
    const { gyro, accel, temperature = 25 } = this.motion(this.#world.now / 1e9);
    const counts = { gyro: this.#gyroCounts(gyro), accel: this.#accelCounts(accel) };
    const raw = [Math.round((temperature - 25) * 256) | 0, ...counts.gyro, ...counts.accel];
    raw.forEach((count, i) => {
      this.#bytes[2 * i] = count & 0xff;
      this.#bytes[2 * i + 1] = (count >> 8) & 0xff;
    });
    const unread = this.#fresh.gyro || this.#fresh.accel;
    this.#fresh.gyro = this.#registers[0x11] >> 4 !== 0;
    this.#fresh.accel = this.#registers[0x10] >> 4 !== 0;
    if (this.keepSamples) this.samples.push({ at: this.#world.now, ...counts, temperature: raw[0], unread });
    this.#updatePin(true);
    this.#reschedule();
  }

  #gyroCounts(rate) {
    const control = this.#registers[0x11];
    const mdps = control & 2 ? 4.375 : GYRO_MDPS[(control >> 2) & 3];
    const test = (this.#registers[0x14] >> 2) & 3;
    const shift = this.selfTestWorks && (test === 1 || test === 3) ? (test === 1 ? 1 : -1) * SELF_TEST.gyroDps : 0;
    return rate.map((axis) => this.#clip(((axis * 180) / Math.PI + (shift * mdps) / 70) * 1000 / mdps));
  }

  #accelCounts(force) {
    const mg = ACCEL_MG[(this.#registers[0x10] >> 2) & 3];
    const test = this.#registers[0x14] & 3;
    const shift = this.selfTestWorks && (test === 1 || test === 2) ? (test === 1 ? 1 : -1) * SELF_TEST.accelMg : 0;
    return force.map((axis) => this.#clip((axis / GRAVITY * 1000 + shift) / mg));
  }

  #clip(counts) {
    return Math.max(-32768, Math.min(32767, Math.round(counts))) | 0;
  }

  #updatePin(sampled = false) {
    const routed = this.#registers[0x0d];
    const wanted = (routed & 2 && this.#fresh.gyro) || (routed & 1 && this.#fresh.accel);
    const pulsed = (this.#registers[0x0b] & 0x80) !== 0;
    const inverted = (this.#registers[0x12] & 0x20) !== 0;
    if (pulsed && !sampled) return;
    const level = Boolean(wanted) && this.dataReadyWorks;
    if (pulsed && level) this.#world.after(PULSE_NANOS, () => this.#setPin(inverted));
    this.#setPin(level !== inverted);
  }

  #setPin(level) {
    if (level === this.#pin) return;
    this.#pin = level;
    this.#onPin(level);
  }
}
