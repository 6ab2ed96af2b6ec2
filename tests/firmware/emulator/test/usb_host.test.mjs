// The strict host by itself: it enumerates a right device, and names every rule that a wrong one breaks.
import assert from 'node:assert/strict';
import test from 'node:test';

import { judge } from '../host/descriptors.mjs';
import { enumerate } from '../host/enumeration.mjs';
import { UsbHost } from '../host/usb_host.mjs';
import { CONFIGURATION, DEVICE_DESCRIPTOR, fakeBoard, FakeDevice } from './fake_device.mjs';

function plug(flaw) {
  const device = new FakeDevice();
  device.flaw = flaw;
  const board = fakeBoard(device);
  return { device, board, host: new UsbHost(board) };
}

test('a right device is enumerated', () => {
  const { board, host } = plug(null);
  const { strings, configuration } = enumerate(board, host);
  assert.equal(strings.product, 'slamd');
  assert.equal(configuration.interfaces.length, 3);
  board.faults.assertNone();
});

for (const [flaw, message] of [
  ['data stage starts with DATA0', /DATA0 where DATA1 is due/],
  ['toggle stands still', /DATA1 where DATA0 is due/],
  ['more than asked for', /bytes, asked for/],
  ['never ready', /NAK for 500 ms/],
  ['refuses the status stage', /status stage: STALL/],
  ['deaf to addresses', /answers at its old address/],
]) {
  test(`a device is refused whose flaw is: ${flaw}`, () => {
    const { board, host } = plug(flaw);
    assert.throws(() => enumerate(board, host), message);
  });
}

test('a device without pull-up is not found', () => {
  const { device, board, host } = plug(null);
  device.attached = false;
  assert.throws(() => enumerate(board, host), /does not show itself/);
});

test('a stream whose toggle stands still is a fault', () => {
  const { device, board, host } = plug('stream toggle stands still');
  enumerate(board, host);
  device.stream = [[1], [2]];
  const got = [];
  host.openPipe(2, 64, (bytes) => got.push(...bytes));
  board.run(1e6);
  assert.deepEqual(got, [1, 2]);
  assert.equal(board.faults.take(/DATA0 is not due/), 1);
});

const changed = (at, value) => Uint8Array.from(CONFIGURATION, (byte, i) => (i === at ? value : byte));

for (const [what, at, value, message] of [
  ['total length', 2, 83, /wTotalLength/],
  ['number of interfaces', 4, 2, /bNumInterfaces/],
  ['reserved attribute bit', 7, 0, /reserved attributes/],
  ['more than 500 mA', 8, 255, /mA/],
  ['association of the wrong interface', 11, 1, /association/],
  ['number of endpoints', 21, 2, /bNumEndpoints/],
  ['union with itself', 44, 0, /union/],
  ['bulk packets of 576', 66, 2, /bulk packets of/],
  ['endpoint address twice', 70, 0x02, /twice/],
  ['interrupt interval 0', 51, 0, /interval 0/],
  ['no line coding', 39, 0, /ACM/],
]) {
  test(`a configuration is refused for: ${what}`, () => {
    assert.deepEqual(judge(DEVICE_DESCRIPTOR, Uint8Array.from(CONFIGURATION)), []);
    assert.match(judge(DEVICE_DESCRIPTOR, changed(at, value)).join('; '), message);
  });
}
