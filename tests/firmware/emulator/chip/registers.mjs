// Peripherals that rp2040js lacks or models too kindly are made from this: registers by offset. It has no behaviour.
import { BasePeripheral } from 'rp2040js';

/**
 * `read` and `write` map an offset to a function; an offset without one is a fault. A write function gets the new value
 * and the raw one (for bits that are cleared by writing 1, where the atomic alias must not matter).
 */
export class Registers extends BasePeripheral {
  reads = new Map();
  writes = new Map();

  /** A register that keeps what is written under `mask`. */
  keep(offset, initial = 0, mask = 0xffffffff) {
    let value = initial >>> 0;
    this.reads.set(offset, () => value);
    this.writes.set(offset, (next) => {
      value = (next & mask) >>> 0;
    });
  }

  readUint32(offset) {
    const read = this.reads.get(offset & 0xfff);
    if (read) return read() >>> 0;
    this.error(`read of 0x${(offset & 0xfff).toString(16)}, which is not modelled`);
    return 0;
  }

  writeUint32(offset, value) {
    const write = this.writes.get(offset);
    if (write) write(value >>> 0, this.rawWriteValue >>> 0);
    else this.error(`write of 0x${offset.toString(16)}, which is not modelled`);
  }
}
