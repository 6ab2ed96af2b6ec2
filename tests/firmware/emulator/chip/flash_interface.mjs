// The SSI with the flash chip behind it, and the QSPI pads' chip select: memory-mapped reads and single commands.
import { Registers } from './registers.mjs';

const ENTER_XIP = { command: 0x03, instructionBits: 2, addressNibbles: 6, transfer: 0, waitCycles: 0, mode: 3, frame: 31 };
const READ_MAX_HZ = 50e6; // command 03h: AT25SF128A and IS25LP128F data sheets, the lower of both

/** The flash chip on single commands: read unique id (4Bh), JEDEC id (9Fh), status (05h). */
class FlashChip {
  #bytes = [];

  constructor(uniqueId, jedecId) {
    this.uniqueId = uniqueId;
    this.jedecId = jedecId;
  }

  select() {
    this.#bytes = [];
  }

  exchange(byte) {
    const at = this.#bytes.push(byte) - 1;
    if (this.#bytes[0] === 0x4b) return at >= 5 ? this.uniqueId[(at - 5) % this.uniqueId.length] : 0xff;
    if (this.#bytes[0] === 0x9f) return at >= 1 ? this.jedecId[(at - 1) % this.jedecId.length] : 0xff;
    if (this.#bytes[0] === 0x05) return at >= 1 ? 0 : 0xff;
    if (at === 0) this.unknownCommand = byte;
    return 0xff;
  }
}

export class FlashInterface extends Registers {
  #enabled = false;
  #received = [];
  #selectedBySoftware = false;
  #flash;
  #field = { ctrlr0: 0, spiCtrlr0: 0, baudr: 0 };
  commands = 0; // bytes exchanged outside memory-mapped reads

  constructor(rp2040, uniqueId) {
    super(rp2040, 'SSI');
    this.#flash = new FlashChip(uniqueId, [0x1f, 0x89, 0x01]);
    this.#keepField(0x00, 'ctrlr0');
    this.keep(0x04);
    this.reads.set(0x08, () => Number(this.#enabled));
    this.writes.set(0x08, (value) => this.#enable((value & 1) !== 0));
    this.keep(0x10, 1);
    this.#keepField(0x14, 'baudr');
    this.reads.set(0x20, () => 0);
    this.reads.set(0x24, () => this.#received.length);
    this.reads.set(0x28, () => 0b110 | (this.#received.length ? 8 : 0));
    for (const offset of [0x18, 0x1c, 0x2c, 0x4c, 0xf0, 0xf8]) this.keep(offset);
    this.reads.set(0x48, () => 0);
    this.reads.set(0x60, () => this.#received.shift() ?? 0);
    this.writes.set(0x60, (value) => this.#send(value & 0xff));
    this.#keepField(0xf4, 'spiCtrlr0');
  }

  /** Whether flash can be read as memory now. */
  get mapped() {
    return this.#enabled && this.#continuousRead();
  }

  get clockHz() {
    return this.#field.baudr ? this.rp2040.clkSys / this.#field.baudr : 0;
  }

  get clockAllowed() {
    return this.clockHz > 0 && this.clockHz <= READ_MAX_HZ;
  }

  /** From IO_QSPI: software drives chip select low (true) or leaves it to the SSI. */
  selectBySoftware(low) {
    if (low && !this.#selectedBySoftware) this.#flash.select();
    this.#selectedBySoftware = low;
  }

  /** As the ROM's flash_exit_xip leaves it: single bytes. */
  leaveMapped() {
    this.#enabled = true;
    this.#field = { ctrlr0: 7 << 16, spiCtrlr0: 0, baudr: 6 };
    this.#received = [];
  }

  /** As the ROM's flash_enter_cmd_xip leaves it: slow command 03h. */
  enterMapped() {
    this.#enabled = true;
    this.#field = { ctrlr0: (3 << 8) | (31 << 16), spiCtrlr0: 0x03000218, baudr: 12 };
  }

  #keepField(offset, name) {
    this.reads.set(offset, () => this.#field[name]);
    this.writes.set(offset, (value) => {
      if (this.#enabled) this.error(`${name} written while SSI is enabled`);
      this.#field[name] = value;
    });
  }

  #enable(on) {
    this.#enabled = on;
    this.#received = [];
    if (on && (this.#field.baudr < 2 || this.#field.baudr & 1)) this.error(`divider ${this.#field.baudr}`);
  }

  #continuousRead() {
    const { ctrlr0, spiCtrlr0 } = this.#field;
    const set = {
      command: spiCtrlr0 >>> 24, instructionBits: (spiCtrlr0 >> 8) & 3, addressNibbles: (spiCtrlr0 >> 2) & 15,
      transfer: spiCtrlr0 & 3, waitCycles: (spiCtrlr0 >> 11) & 31, mode: (ctrlr0 >> 8) & 3, frame: (ctrlr0 >> 16) & 31,
    };
    return Object.keys(ENTER_XIP).every((key) => set[key] === ENTER_XIP[key]);
  }

  #send(byte) {
    if (!this.#enabled) return this.error('byte sent while SSI is disabled');
    if (!this.#selectedBySoftware) this.error('command byte without chip select');
    if (this.#received.length === 16) return this.error('receive FIFO overrun');
    this.commands += 1;
    this.#received.push(this.#flash.exchange(byte));
    if (this.#flash.unknownCommand !== undefined) {
      this.error(`flash command 0x${this.#flash.unknownCommand.toString(16)}`);
      this.#flash.unknownCommand = undefined;
    }
  }
}

/** IO_QSPI: only the chip select's output override matters. */
export class QspiPads extends Registers {
  constructor(rp2040, flash) {
    super(rp2040, 'IO_QSPI');
    for (let pin = 0; pin < 6; pin += 1) {
      this.keep(8 * pin, 0);
      this.keep(8 * pin + 4, 0);
    }
    const keepSelect = this.writes.get(0x0c);
    this.writes.set(0x0c, (value) => {
      keepSelect(value);
      flash.selectBySoftware(((value >> 8) & 3) === 2);
    });
  }
}
