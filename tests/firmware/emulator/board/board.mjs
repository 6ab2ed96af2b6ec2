// The Arduino Nano RP2040 Connect as far as the firmware sees it: chip, flash, sensor, reset button, USB plug, LED. It
// runs the chip through true time; a test works with it and with the host at the plug.
import { readFileSync } from 'node:fs';

import { Chip, freshMemory } from '../chip/chip.mjs';
import { Faults } from '../chip/faults.mjs';
import { readUf2 } from '../chip/uf2.mjs';
import { World } from '../chip/world.mjs';
import { Lsm6dsox } from './lsm6dsox.mjs';
import { TwoWireBus } from './two_wire_bus.mjs';

const INT1_PIN = 24;
const LED_PIN = 6;
const FLASH_ID = [0xe4, 0x62, 0x5c, 0x71, 0x03, 0x9b, 0x2f, 0x28];

export const MILLISECOND = 1e6;
export const SECOND = 1e9;

/** The image under test: SLAMD_FIRMWARE names a .uf2 or .bin file. */
export function firmwareUnderTest() {
  const path = process.env.SLAMD_FIRMWARE;
  if (!path) throw new Error('SLAMD_FIRMWARE has to name the firmware, a .uf2 or .bin file');
  const bytes = new Uint8Array(readFileSync(path));
  return path.endsWith('.uf2') ? readUf2(bytes) : bytes;
}

export class Board {
  world = new World();
  faults = new Faults(this.world);
  sensor = new Lsm6dsox(this.world);
  resets = []; // { at, cause }: 'power', 'button', 'watchdog timer', 'watchdog force'
  bootLoader = null; // { at, activityPins, disabledInterfaces } once it was entered
  ledChanges = []; // { at, on }
  chip = null;
  #bus = new TwoWireBus(this.sensor, this.faults);
  #image;
  #flashId;
  #timerStart;
  #onAttach = () => {};
  #pendingReset = null;

  /** timerStart: microseconds that the timer shows at power-on, as if the board had run so long. */
  constructor({ image = firmwareUnderTest(), flashId = FLASH_ID, timerStart = 0 } = {}) {
    this.#image = image;
    this.#flashId = flashId;
    this.#timerStart = timerStart;
    this.sensor.onDataReady((level) => this.chip?.rp2040.gpio[INT1_PIN].setInputValue(level));
  }

  get bus() {
    return this.#bus;
  }

  /** Calls action(attached) when the device shows itself to the host or leaves. */
  onAttach(action) {
    this.#onAttach = action;
  }

  powerOn() {
    this.sensor.powerOn();
    this.#start({ ...freshMemory(), ticks: this.#timerStart }, 'power');
  }

  /** The reset button: everything but SRAM starts anew. */
  tapReset() {
    this.#start({ ...freshMemory(), sram: this.chip.memory.sram }, 'button');
  }

  get running() {
    return this.chip !== null && this.bootLoader === null;
  }

  /** Runs for `nanos` of true time. */
  run(nanos) {
    const end = this.world.now + nanos;
    while (this.world.now < end) this.#advance(end);
  }

  /** Runs until done() is true, asked after every instruction and event. Returns false when `nanos` passed before. */
  runUntil(done, nanos) {
    const end = this.world.now + nanos;
    while (!done()) {
      if (this.world.now >= end) return false;
      this.#advance(end);
    }
    return true;
  }

  #advance(end) {
    if (!this.running) this.world.advanceTo(Math.min(end, this.world.nextAt));
    else if (this.chip.sleeping) this.chip.sleepUntil(end);
    else this.chip.step();
    if (this.#pendingReset) this.#restart();
  }

  #restart() {
    const cause = this.#pendingReset === 2 ? 'watchdog force' : 'watchdog timer';
    const { sram, scratch } = this.chip.memory;
    const reason = this.#pendingReset;
    this.#pendingReset = null;
    this.#start({ sram, scratch, reason }, cause);
  }

  #start(memory, cause) {
    this.chip?.stop();
    this.#onAttach(false);
    this.resets.push({ at: this.world.now, cause });
    this.bootLoader = null;
    this.chip = new Chip(this.world, this.faults, {
      image: this.#image, flashId: this.#flashId, memory, i2cBus: this.#bus, byRunPin: this.#lastIsButton(),
      onWatchdog: (reason) => (this.#pendingReset = reason),
      onBootLoader: (pins, disabled) => this.#enterBootLoader(pins, disabled),
    });
    this.#bus.attach(this.chip.rp2040);
    this.#watchPins();
    this.chip.usb.onPullUp((attached) => this.#onAttach(attached));
    if (!this.chip.start()) this.#enterBootLoader(0, 0);
  }

  /** The chip's own record of its last reset, which one by the watchdog leaves as it is. */
  #lastIsButton() {
    return this.resets.filter(({ cause }) => !cause.startsWith('watchdog')).at(-1).cause === 'button';
  }

  #watchPins() {
    const { gpio } = this.chip.rp2040;
    gpio[INT1_PIN].setInputValue(this.sensor.dataReady);
    gpio[LED_PIN].addListener(() => this.ledChanges.push({ at: this.world.now, on: gpio[LED_PIN].value === 1 }));
  }

  #enterBootLoader(activityPins, disabledInterfaces) {
    this.bootLoader = { at: this.world.now, activityPins, disabledInterfaces };
    this.chip.stop();
    this.#onAttach(false);
  }
}
