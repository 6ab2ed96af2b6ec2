// One start of an RP2040: rp2040js with its gaps filled. A reset makes a new one; what survives is handed in and out.
import { RP2040 } from 'rp2040js';

import { BootRom } from './boot_rom.mjs';
import { checkAlignment, correctCore } from './core.mjs';
import { FlashInterface, QspiPads } from './flash_interface.mjs';
import { I2cController } from './i2c_controller.mjs';
import { Registers } from './registers.mjs';
import { ResetController } from './reset_controller.mjs';
import { Timer } from './timer.mjs';
import { UsbController } from './usb_controller.mjs';
import { Watchdog } from './watchdog.mjs';
import { ChipClock } from './world.mjs';

const PAD_RESET = 0x56; // input enabled, pulled down (data sheet 2.19.6.3)
const FLASH_FROM = 0x10000000;
const FLASH_TO = 0x14000000;

/** What a start leaves for the next one: `scratch` of the watchdog and `sram` survive all but loss of power. */
export function freshMemory() {
  const sram = new Uint8Array(264 * 1024);
  for (let i = 0; i < sram.length; i += 1) sram[i] = (i * 197 + (i >> 8) * 31) & 0xff; // undefined, but the same every time
  return { sram, scratch: new Array(8).fill(0), reason: 0 };
}

export class Chip {
  #core;
  sleptCycles = 0;
  busyCycles = 0;

  /**
   * `options`: image (flash from its start), flashId (8 bytes), memory (freshMemory or of the chip before), i2cBus,
   * byRunPin (the start is by power or the RUN pin), onWatchdog(reason), onBootLoader(pin, disabled).
   */
  constructor(world, faults, options) {
    this.world = world;
    this.faults = faults;
    this.clock = new ChipClock(world);
    this.rp2040 = new RP2040(this.clock);
    const { rp2040 } = this;
    rp2040.logger = faults.logger();
    rp2040.flash.set(options.image);
    rp2040.sram.set(options.memory.sram);
    this.memory = { ...options.memory, sram: rp2040.sram };
    for (const pin of rp2040.gpio) pin.padValue = PAD_RESET;
    this.#core = correctCore(rp2040, faults);
    this.#makePeripherals(options);
    this.#placePeripherals(options.byRunPin);
    this.#guardMemory();
    rp2040.updateClocks();
    rp2040.clkSys = rp2040.roscFreq;
    this.rom = new BootRom(rp2040, faults, this.flash, options.onBootLoader);
  }

  /** The boot ROM's start from flash; false when it goes to the boot loader instead. */
  start() {
    return this.rom.startFromFlash();
  }

  /** No alarm of this chip fires any more. */
  stop() {
    this.clock.stop();
  }

  get sleeping() {
    return this.rp2040.core.waiting;
  }

  /** One instruction or one function of the ROM; moves the world's time on. */
  step() {
    const { core } = this.rp2040;
    if (BootRom.contains(core.PC)) {
      this.rom.execute();
      return;
    }
    const cycles = core.executeInstruction() + this.#core.takeExceptionCycles();
    this.#core.wakeIfPending();
    this.busyCycles += cycles;
    this.world.advanceTo(this.world.now + (cycles * 1e9) / this.rp2040.clkSys);
  }

  /** Sleeps until the next event, at most until `target`. */
  sleepUntil(target) {
    const from = this.world.now;
    this.world.advanceTo(Math.min(this.world.nextAt, target));
    this.sleptCycles += ((this.world.now - from) * this.rp2040.clkSys) / 1e9;
  }

  #makePeripherals({ flashId, memory, i2cBus, onWatchdog }) {
    const { rp2040, clock } = this;
    this.resets = new ResetController(rp2040);
    this.flash = new FlashInterface(rp2040, flashId);
    this.watchdog = new Watchdog(rp2040, clock, this.memory, onWatchdog);
    this.timer = new Timer(rp2040, clock, this.watchdog);
    this.i2c = new I2cController(rp2040, clock, i2cBus);
    this.usb = new UsbController(rp2040, clock, this.faults);
    rp2040.usbCtrl = this.usb;
    this.resets.onAssert('i2c0', () => this.i2c.reset());
    this.resets.onAssert('usbctrl', () => this.usb.reset());
  }

  #placePeripherals(byRunPin) {
    const { peripherals } = this.rp2040;
    const place = (key, name, peripheral) => {
      peripherals[key] = name ? this.resets.gate(name, peripheral) : peripheral;
    };
    place(0x18000, null, this.flash);
    place(0x4000c, null, this.resets);
    place(0x40018, 'io_qspi', new QspiPads(this.rp2040, this.flash));
    place(0x40044, 'i2c0', this.i2c);
    place(0x40054, 'timer', this.timer);
    place(0x40058, null, this.watchdog);
    place(0x40060, null, this.#ringOscillator());
    place(0x40064, null, this.#chipReset(byRunPin));
    place(0x50110, 'usbctrl', this.usb);
    const gated = { 0x40000: 'sysinfo', 0x40004: 'syscfg', 0x40014: 'io_bank0', 0x4001c: 'pads_bank0', 0x40028: 'pll_sys',
      0x4002c: 'pll_usb', 0x40030: 'busctrl', 0x4004c: 'adc', 0x40050: 'pwm', 0x50000: 'dma' };
    for (const [key, name] of Object.entries(gated)) place(key, name, peripherals[key]);
  }

  #ringOscillator() {
    const rosc = new Registers(this.rp2040, 'ROSC');
    for (const offset of [0x00, 0x04, 0x08, 0x0c, 0x10, 0x14]) rosc.keep(offset);
    rosc.reads.set(0x18, () => 0x80001000);
    return rosc;
  }

  #chipReset(byRunPin) {
    const registers = new Registers(this.rp2040, 'VREG_AND_CHIP_RESET');
    registers.keep(0x0, 0x10b1);
    registers.keep(0x4, 0x91);
    registers.reads.set(0x8, () => (byRunPin ? 1 << 16 : 1 << 8));
    return registers;
  }

  /** Flash reads as memory only while the SSI is set up for it; odd addresses are hard faults. */
  #guardMemory() {
    const { rp2040, faults, flash } = this;
    checkAlignment(rp2040, faults);
    for (const name of ['readUint8', 'readUint16', 'readUint32']) {
      const original = rp2040[name];
      rp2040[name] = (address) => {
        if (address >= FLASH_FROM && address < FLASH_TO && !flash.mapped) {
          faults.add('flash', `${name} while the flash is not set up as memory`);
        }
        return original.call(rp2040, address);
      };
    }
    const write = rp2040.writeUint32;
    rp2040.writeUint32 = (address, value) => {
      if (address >>> 0 < FLASH_TO) faults.add('core', `write to 0x${(address >>> 0).toString(16)}`);
      write.call(rp2040, address, value);
    };
  }
}
