// Reads a UF2 file as the boot ROM would: blocks of the RP2040 family into an image of the flash.

const MAGIC = [0x0a324655, 0x9e5d5157, 0x0ab16f30];
const RP2040_FAMILY = 0xe48bff56;
const FLASH_BASE = 0x10000000;

/** The flash's first bytes. Throws on the first block that is not as it should be. */
export function readUf2(bytes) {
  if (bytes.length === 0 || bytes.length % 512) throw new Error(`UF2: ${bytes.length} bytes are not whole blocks`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const count = bytes.length / 512;
  const parts = [];
  for (let i = 0; i < count; i += 1) {
    const word = (at) => view.getUint32(512 * i + at, true);
    if (word(0) !== MAGIC[0] || word(4) !== MAGIC[1] || word(508) !== MAGIC[2]) throw new Error(`UF2: block ${i}: magic`);
    if (!(word(8) & 0x2000) || word(28) !== RP2040_FAMILY) throw new Error(`UF2: block ${i}: family`);
    if (word(20) !== i || word(24) !== count) throw new Error(`UF2: block ${i}: numbered ${word(20)} of ${word(24)}`);
    if (word(16) !== 256) throw new Error(`UF2: block ${i}: ${word(16)} bytes`);
    parts.push({ at: word(12) - FLASH_BASE, data: bytes.subarray(512 * i + 32, 512 * i + 288) });
  }
  const image = new Uint8Array(Math.max(...parts.map((part) => part.at + 256))).fill(0xff);
  for (const { at, data } of parts) image.set(data, at);
  return image;
}
