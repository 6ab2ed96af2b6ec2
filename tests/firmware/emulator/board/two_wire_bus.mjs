// SDA (GPIO12) and SCL (GPIO13) with their pull-ups: the controller's transfers, and levels when software drives the pins.
// It has one device; of the others on the board nothing is modelled.

const SDA = 12;
const SCL = 13;
const FUNCTION_I2C = 3;
const DRIVEN_LOW = 0;
const DRIVEN_HIGH = 1;

/** `device`: address, start(isRead) -> ack, write(byte) -> ack, read() -> byte, stop(), holdsSda, clockPulse(), onSda(action). */
export class TwoWireBus {
  #device;
  #faults;
  #gpio = null;
  #freeActions = [];
  #addressed = false;
  #sclWas = true;
  #sdaWas = true;
  pulses = 0; // of SCL made by software

  constructor(device, faults) {
    this.#device = device;
    this.#faults = faults;
    device.onSda(() => this.#levelsChanged());
  }

  /** The pins of a newly started chip. */
  attach(rp2040) {
    this.#gpio = rp2040.gpio;
    this.#freeActions = [];
    for (const pin of [SDA, SCL]) this.#gpio[pin].addListener(() => this.#pinChanged(pin));
    this.#levelsChanged();
  }

  get connected() {
    return [SDA, SCL].every((pin) => this.#gpio[pin].functionSelect === FUNCTION_I2C);
  }

  get sdaHeld() {
    return this.#device.holdsSda;
  }

  onFree(action) {
    this.#freeActions.push(action);
  }

  start(address, isRead) {
    this.#addressed = address === this.#device.address && this.#device.start(isRead);
    return this.#addressed;
  }

  write(byte) {
    return this.#addressed && this.#device.write(byte);
  }

  read() {
    if (this.#device.holdsSda) return 0;
    return this.#addressed ? this.#device.read() : 0xff;
  }

  stop() {
    if (this.#addressed) this.#device.stop();
    this.#addressed = false;
  }

  #low(pin) {
    return this.#gpio[pin].value === DRIVEN_LOW;
  }

  #pinChanged(pin) {
    if (this.#gpio[pin].value === DRIVEN_HIGH) this.#faults.add('I2C pins', `GPIO${pin} driven high on an open-drain bus`);
    this.#levelsChanged();
  }

  #levelsChanged() {
    if (!this.#gpio) return;
    const scl = !this.#low(SCL);
    if (scl && !this.#sclWas) {
      this.pulses += 1;
      this.#sclWas = scl;
      this.#device.clockPulse();
    }
    this.#sclWas = scl;
    const sda = !this.#low(SDA) && !this.#device.holdsSda;
    if (sda && !this.#sdaWas && scl) this.#device.stop();
    this.#sdaWas = sda;
    this.#drive(SDA, sda);
    this.#drive(SCL, scl);
    if (sda && scl && this.connected) for (const action of this.#freeActions) action();
  }

  #drive(pin, level) {
    if (this.#gpio[pin].rawInputValue !== level) this.#gpio[pin].setInputValue(level);
  }
}
