// The bench's own reader of the wire format, against fixed bytes.
import assert from 'node:assert/strict';
import test from 'node:test';

import { bootCrc32 } from '../chip/crc32.mjs';
import { command, crc16, PacketReader } from '../host/packets.mjs';

test('CRC-16 has its published check value', () => {
  assert.equal(crc16(new TextEncoder().encode('123456789')), 0x29b1);
});

test('the CRC-32 of the second stage has its published check value (MPEG-2)', () => {
  assert.equal(bootCrc32(new TextEncoder().encode('123456789')), 0x0376e6e7);
});

test('a command is 8 bytes with one zero, at the end', () => {
  const bytes = command(1, 0x0100);
  assert.equal(bytes.length, 8);
  assert.equal(bytes.indexOf(0), 7);
});

test('a packet after garbage is read, garbage is told', () => {
  const reader = new PacketReader();
  const plain = [0x51, 4, 7, 0, 1, 0];
  const crc = crc16(plain);
  const packet = [4, 0x51, 4, 7, 2, 1, 3, crc & 0xff, crc >> 8, 0];
  reader.push([9, 9, 9, 0, ...packet], 5);
  assert.equal(reader.bad.length, 1);
  assert.deepEqual(reader.packets, [{ kind: 'acknowledgement', code: 4, tag: 7, result: 1, at: 5 }]);
});
