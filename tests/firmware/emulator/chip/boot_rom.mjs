// A stub of the boot ROM: its tables, and its functions done by the test bench when the core arrives at them. The start
// from flash is here too: second stage checked, copied and entered as the RP2040 data sheet, 2.8.1, says.
import { bootCrc32 } from './crc32.mjs';

const FUNCTIONS_AT = 0x200;
const TABLE_AT = 0x100;
const LOOKUP_AT = 0x1f0;
const STAGE2_AT = 0x20041f00;
const STAGE2_BYTES = 256;
const ROM_BYTES = 0x4000;

const codeOf = (name) => name.charCodeAt(0) | (name.charCodeAt(1) << 8);

export class BootRom {
  #rp2040;
  #faults;
  #functions;
  calls = [];

  /** onBootLoader(activityPin, disabledInterfaces) is called by reset_usb_boot, which does not return. */
  constructor(rp2040, faults, flash, onBootLoader) {
    this.#rp2040 = rp2040;
    this.#faults = faults;
    this.#functions = [
      ['IF', () => flash.leaveMapped()],
      ['EX', () => flash.leaveMapped()],
      ['FC', () => {}],
      ['CX', () => flash.enterMapped()],
      ['UB', (pin, disabled) => onBootLoader(pin, disabled)],
    ];
    this.#writeTables();
  }

  /** Whether the core stands on a function of the ROM. */
  static contains(address) {
    return address < ROM_BYTES;
  }

  /** Does the function at the core's program counter and returns to the caller. */
  execute() {
    const { core } = this.#rp2040;
    const at = core.PC & ~1;
    const [r0, r1] = core.registers;
    if (at === LOOKUP_AT) {
      core.registers[0] = this.#lookup(r0, r1);
    } else {
      const found = this.#functions[(at - FUNCTIONS_AT) / 4];
      if (!found) {
        this.#faults.add('ROM', `jump to 0x${at.toString(16)}`);
        core.waiting = true;
        return;
      }
      this.calls.push(found[0]);
      found[1](r0, r1);
    }
    core.PC = core.LR & ~1;
  }

  /** Starts from flash. Returns false (boot loader) when the second stage's CRC is wrong, as the ROM would. */
  startFromFlash() {
    const { core, flash } = this.#rp2040;
    const stage2 = flash.subarray(0, STAGE2_BYTES);
    const stored = new DataView(stage2.buffer, stage2.byteOffset + 252, 4).getUint32(0, true);
    if (bootCrc32(stage2.subarray(0, 252)) !== stored) return false;
    this.#rp2040.sram.set(stage2, STAGE2_AT - 0x20000000);
    core.SP = STAGE2_AT;
    core.LR = 0;
    core.PC = STAGE2_AT;
    return true;
  }

  #writeTables() {
    const bytes = new Uint8Array(this.#rp2040.bootrom.buffer);
    const view = new DataView(bytes.buffer);
    bytes.set([0x4d, 0x75, 0x01, 0x02], 0x10);
    view.setUint16(0x14, TABLE_AT, true);
    view.setUint16(0x16, TABLE_AT + 4 * this.#functions.length, true); // an empty data table: the terminator
    view.setUint16(0x18, LOOKUP_AT | 1, true);
    this.#functions.forEach(([name], i) => {
      view.setUint16(TABLE_AT + 4 * i, codeOf(name), true);
      view.setUint16(TABLE_AT + 4 * i + 2, (FUNCTIONS_AT + 4 * i) | 1, true);
    });
  }

  #lookup(table, code) {
    const view = new DataView(this.#rp2040.bootrom.buffer);
    for (let at = table; view.getUint16(at, true) !== 0; at += 4) {
      if (view.getUint16(at, true) === (code & 0xffff)) return view.getUint16(at + 2, true);
    }
    this.#faults.add('ROM', `no function 0x${code.toString(16)}`);
    return 0;
  }
}
