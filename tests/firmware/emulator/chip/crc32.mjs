// The boot ROM's CRC-32 of the second stage: polynomial 0x04C11DB7, start 0xFFFFFFFF, not reflected, no final xor.

export function bootCrc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte << 24;
    for (let bit = 0; bit < 8; bit += 1) crc = crc & 0x80000000 ? (crc << 1) ^ 0x04c11db7 : crc << 1;
  }
  return crc >>> 0;
}
