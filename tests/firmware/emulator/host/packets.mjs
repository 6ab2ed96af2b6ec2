// The packets of firmware/protocol, written a second time from its README: COBS, CRC-16, layouts. Shares no code with the
// firmware or the driver, so that an error in theirs is seen.

/** CRC-16/CCITT-FALSE, bit by bit. */
export function crc16(bytes) {
  let crc = 0xffff;
  for (const byte of bytes) {
    crc ^= byte << 8;
    for (let bit = 0; bit < 8; bit += 1) crc = crc & 0x8000 ? ((crc << 1) ^ 0x1021) & 0xffff : (crc << 1) & 0xffff;
  }
  return crc;
}

function cobsDecode(packet) {
  const out = [];
  for (let at = 0; at < packet.length; ) {
    const code = packet[at];
    if (code === 0 || at + code > packet.length) throw new Error('COBS');
    for (let i = 1; i < code; i += 1) out.push(packet[at + i]);
    at += code;
    if (code !== 255 && at < packet.length) out.push(0);
  }
  return Uint8Array.from(out);
}

function cobsEncode(plain) {
  const out = [];
  let block = [];
  for (const byte of [...plain, 0]) {
    if (byte !== 0) block.push(byte);
    else {
      out.push(block.length + 1, ...block);
      block = [];
    }
  }
  return out;
}

/** The bytes of a command on the wire: identity 1, statistics 2, self-test 3, reset 4, boot loader 5. */
export function command(code, tag) {
  const plain = [0x81, code, tag & 0xff, tag >> 8];
  const crc = crc16(plain);
  return [...cobsEncode([...plain, crc & 0xff, crc >> 8]), 0];
}

const READERS = {
  0x11: readSample,
  0x21: readIdentity,
  0x31: readStatistics,
  0x41: readSelfTest,
  0x51: (view) => ({ kind: 'acknowledgement', code: view.getUint8(1), tag: view.getUint16(2, true), result: view.getUint8(4) }),
};
const LENGTHS = { 0x11: 30, 0x21: 24, 0x31: 48, 0x41: 20, 0x51: 8 };

const three = (view, at) => [0, 2, 4].map((i) => view.getInt16(at + i, true));

function readSample(view) {
  return {
    kind: 'sample', status: view.getUint8(1), sequence: view.getUint16(2, true), deviceUs: Number(view.getBigUint64(4, true)),
    gyro: three(view, 12), accel: three(view, 18), temperature: view.getInt16(24, true), dropped: view.getUint16(26, true),
  };
}

function readIdentity(view) {
  const byte = (at) => view.getUint8(at);
  return {
    kind: 'identity', sensorId: byte(1), tag: view.getUint16(2, true), uniqueId: [4, 5, 6, 7, 8, 9, 10, 11].map(byte),
    version: [byte(12), byte(13), byte(14)], chipRevision: byte(15), rateHz: view.getUint16(16, true),
    gyroDps: view.getUint16(18, true), accelG: byte(20),
  };
}

function readStatistics(view) {
  const word = (at) => view.getUint16(at, true);
  return {
    kind: 'statistics', state: view.getUint8(1), tag: word(2), deviceUs: Number(view.getBigUint64(4, true)),
    samples: view.getUint32(12, true), dropped: view.getUint32(16, true), overruns: view.getUint32(20, true),
    faults: view.getUint32(24, true), fault: view.getUint8(28), resetCause: view.getUint8(29), restarts: word(30),
    busRecoveries: word(32), usbResets: word(34), usbSuspends: word(36), badCommands: word(38), latencyMaxUs: word(40),
    loopMaxUs: word(42), queueMaxBytes: word(44),
  };
}

function readSelfTest(view) {
  return { kind: 'selfTest', outcome: view.getUint8(1), tag: view.getUint16(2, true), accelMg: three(view, 4), gyroDdps: three(view, 10),
    failedAxes: view.getUint8(16) };
}

/** One packet without its delimiter to its fields. Throws on COBS, CRC, unknown kind or a length that is not the kind's. */
export function readPacket(packet) {
  const plain = cobsDecode(packet);
  const view = new DataView(plain.buffer);
  if (plain.length < 3 || view.getUint16(plain.length - 2, true) !== crc16(plain.subarray(0, -2))) throw new Error('CRC');
  if (plain.length !== LENGTHS[plain[0]]) throw new Error(`kind 0x${plain[0].toString(16)} with ${plain.length} bytes`);
  return READERS[plain[0]](view);
}

/** Cuts a byte stream into packets. Packets with `at`: the time of the delimiter. */
export class PacketReader {
  packets = [];
  bad = []; // messages
  bytes = 0;
  #open = [];

  push(bytes, at) {
    this.bytes += bytes.length;
    for (const byte of bytes) {
      if (byte !== 0) this.#open.push(byte);
      else if (this.#open.length) this.#close(at);
    }
  }

  #close(at) {
    try {
      this.packets.push({ ...readPacket(this.#open), at });
    } catch (error) {
      this.bad.push(`${(at / 1e6).toFixed(3)} ms: ${error.message}`);
    }
    this.#open = [];
  }

  get samples() {
    return this.packets.filter((packet) => packet.kind === 'sample');
  }

  last(kind) {
    return this.packets.filter((packet) => packet.kind === kind).at(-1);
  }
}
