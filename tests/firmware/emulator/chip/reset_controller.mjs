// RESETS: which blocks are held in reset. After a start that is all of them but those the boot ROM needs.
import { Registers } from './registers.mjs';

const NAMES = [
  'adc', 'busctrl', 'dma', 'i2c0', 'i2c1', 'io_bank0', 'io_qspi', 'jtag', 'pads_bank0', 'pads_qspi', 'pio0', 'pio1',
  'pll_sys', 'pll_usb', 'pwm', 'rtc', 'spi0', 'spi1', 'syscfg', 'sysinfo', 'tbman', 'timer', 'uart0', 'uart1', 'usbctrl',
];
const ALL = (1 << NAMES.length) - 1;
const LEFT_BY_BOOT_ROM = (1 << NAMES.indexOf('io_qspi')) | (1 << NAMES.indexOf('pads_qspi'));

export class ResetController extends Registers {
  #held = ALL & ~LEFT_BY_BOOT_ROM;
  #onAssert = new Map();

  constructor(rp2040) {
    super(rp2040, 'RESETS');
    this.reads.set(0x0, () => this.#held);
    this.writes.set(0x0, (value) => this.#hold(value & ALL));
    this.keep(0x4, 0, ALL);
    this.reads.set(0x8, () => ~this.#held & ALL);
  }

  held(name) {
    return (this.#held & (1 << NAMES.indexOf(name))) !== 0;
  }

  /** Calls `action` whenever the block `name` is put into reset. */
  onAssert(name, action) {
    this.#onAssert.set(name, action);
  }

  /** `peripheral` behind a gate: touching it while it is held in reset is a fault. */
  gate(name, peripheral) {
    const check = (verb, offset) => {
      if (this.held(name)) this.error(`${verb} of ${name}+0x${(offset & 0xfff).toString(16)} while it is in reset`);
    };
    return {
      readUint32: (offset) => {
        check('read', offset);
        return peripheral.readUint32(offset & 0xfff);
      },
      writeUint32Atomic: (offset, value, type) => {
        check('write', offset);
        peripheral.writeUint32Atomic(offset, value, type);
      },
    };
  }

  #hold(mask) {
    const newly = mask & ~this.#held;
    this.#held = mask;
    NAMES.forEach((name, bit) => {
      if (newly & (1 << bit)) this.#onAssert.get(name)?.();
    });
  }
}
