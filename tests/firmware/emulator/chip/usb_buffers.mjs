// Endpoint control, buffer control and buffers in the USB controller's dual-port RAM, single-buffered. Checks the rules of
// handing over (data sheet 4.1.2.5): AVAILABLE last and later than the rest, no touching of a buffer that is handed over.

const AVAILABLE = 1 << 10;
const STALL = 1 << 11;
const DATA1 = 1 << 13;
const FULL = 1 << 15;
const LENGTH = 0x3ff;
const ENABLED = 0x80000000;
const PER_BUFFER = 1 << 29;
const DOUBLE = 1 << 30;
const HANDOVER_NANOS = 3e9 / 48e6; // three cycles of clk_usb
const EP0_BUFFER = 0x100;

const controlAt = (endpoint, out) => 8 * endpoint + 4 * out; // endpoints 1 to 15
const bufferControlAt = (endpoint, out) => 0x80 + 8 * endpoint + 4 * out;

export class EndpointBuffers {
  #rp2040;
  #clock;
  #faults;
  #onArmed;
  #last = new Map(); // offset of a buffer control -> { value, changedAt }
  #handedOver = []; // { from, bytes: as handed over, control: offset of its buffer control }

  constructor(rp2040, clock, faults, onArmed) {
    this.#rp2040 = rp2040;
    this.#clock = clock;
    this.#faults = faults;
    this.#onArmed = onArmed;
  }

  interrupts(endpoint, out) {
    return (this.#control(endpoint, out) & PER_BUFFER) !== 0;
  }

  /** Endpoint 1..15 as set up by the firmware: { enabled, type, at }. */
  describe(endpoint, out) {
    const control = this.#control(endpoint, out);
    return { enabled: (control & ENABLED) !== 0, type: (control >> 26) & 3, at: control & 0xffc0 };
  }

  /** The firmware wrote the word at `offset`. */
  written(offset, value) {
    if (offset >= 0x100) this.#checkUntouched(offset);
    else if (offset >= 0x80) this.#bufferControlWritten(offset, value);
  }

  /** The host takes an IN buffer. */
  take(endpoint, stallArmed) {
    const offset = bufferControlAt(endpoint, 0);
    const word = this.#word(offset);
    if (endpoint !== 0 && !this.describe(endpoint, 0).enabled) return 'timeout';
    if (word & STALL && (endpoint !== 0 || stallArmed)) return 'stall';
    if (!(word & AVAILABLE)) return 'nak';
    const at = this.#bufferAt(endpoint, 0);
    const bytes = this.#rp2040.usbDPRAM.slice(at, at + (word & LENGTH));
    this.#handBack(offset, word & ~(AVAILABLE | FULL));
    return { pid: word & DATA1 ? 1 : 0, bytes };
  }

  /** The host gives a packet to an OUT buffer. Returns 'ack', 'nak', 'stall', 'timeout' or 'sequence' (acknowledged, dropped). */
  give(endpoint, pid, bytes, stallArmed) {
    const offset = bufferControlAt(endpoint, 1);
    const word = this.#word(offset);
    if (endpoint !== 0 && !this.describe(endpoint, 1).enabled) return 'timeout';
    if (word & STALL && (endpoint !== 0 || stallArmed)) return 'stall';
    if (!(word & AVAILABLE)) return 'nak';
    if ((word & DATA1 ? 1 : 0) !== pid) return 'sequence';
    if (bytes.length > (word & LENGTH)) {
      this.#faults.add('USB', `endpoint ${endpoint} OUT: ${bytes.length} bytes for a buffer of ${word & LENGTH}`);
      return 'timeout';
    }
    this.#rp2040.usbDPRAM.set(bytes, this.#bufferAt(endpoint, 1));
    this.#handBack(offset, (word & ~(AVAILABLE | LENGTH)) | FULL | bytes.length);
    return 'ack';
  }

  #word(offset) {
    return this.#rp2040.usbDPRAMView.getUint32(offset, true);
  }

  #control(endpoint, out) {
    return this.#word(controlAt(endpoint, out ? 1 : 0));
  }

  #bufferAt(endpoint, out) {
    return endpoint === 0 ? EP0_BUFFER : this.describe(endpoint, out).at;
  }

  #handBack(offset, word) {
    this.#rp2040.usbDPRAMView.setUint32(offset, word, true);
    this.#last.set(offset, { value: word, changedAt: this.#clock.nanos });
    this.#handedOver = this.#handedOver.filter((entry) => entry.control !== offset);
  }

  #bufferControlWritten(offset, value) {
    const endpoint = (offset - 0x80) >> 3;
    const out = (offset >> 2) & 1;
    const last = this.#last.get(offset) ?? { value: 0, changedAt: -Infinity };
    const rest = (word) => word & ~AVAILABLE;
    if (value & AVAILABLE && !(last.value & AVAILABLE)) {
      if (rest(value) !== rest(last.value)) this.#fault(endpoint, out, 'AVAILABLE set together with other bits');
      if (this.#clock.nanos - last.changedAt < HANDOVER_NANOS) this.#fault(endpoint, out, 'AVAILABLE set too soon');
      if (!out !== ((value & FULL) !== 0)) this.#fault(endpoint, out, 'FULL does not fit the direction');
      if (endpoint !== 0) this.#checkControl(endpoint, out);
    }
    const changedAt = rest(value) !== rest(last.value) ? this.#clock.nanos : last.changedAt;
    this.#last.set(offset, { value, changedAt });
    this.#handedOver = this.#handedOver.filter((entry) => entry.control !== offset);
    if (!(value & AVAILABLE)) return;
    const at = this.#bufferAt(endpoint, out);
    this.#handedOver.push({ from: at, bytes: this.#rp2040.usbDPRAM.slice(at, at + (value & LENGTH)), control: offset });
    if (!out) this.#onArmed(endpoint);
  }

  #checkControl(endpoint, out) {
    const { enabled, at } = this.describe(endpoint, out);
    if (!enabled) this.#fault(endpoint, out, 'handed over while the endpoint is disabled');
    if (at < 0x180 || at > 0x1000 - 64) this.#fault(endpoint, out, `buffer at 0x${at.toString(16)}`);
    if (this.#control(endpoint, out) & DOUBLE) this.#fault(endpoint, out, 'double buffering is not modelled');
  }

  /** Zeros are let pass: the firmware blanks a packet that nobody fetched, and half of one blanked fails its CRC. */
  #checkUntouched(offset) {
    for (const { from, bytes, control } of this.#handedOver) {
      if (control < 0x88 || offset + 4 <= from || offset >= from + bytes.length) continue;
      const now = this.#rp2040.usbDPRAM.subarray(from, from + bytes.length);
      if (now.some((byte, i) => byte !== bytes[i] && byte !== 0)) {
        this.#fault((control - 0x80) >> 3, (control >> 2) & 1, 'buffer written while the controller owns it');
      }
    }
  }

  #fault(endpoint, out, what) {
    this.#faults.add('USB', `endpoint ${endpoint} ${out ? 'OUT' : 'IN'}: ${what}`);
  }
}
