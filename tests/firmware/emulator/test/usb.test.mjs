// The firmware's USB device at a strict host: enumeration, resets, stalls, toggles, suspend, requests of every kind.
import assert from 'node:assert/strict';
import test from 'node:test';

import { Board, MILLISECOND } from '../board/board.mjs';
import { setAddress } from '../host/enumeration.mjs';
import { SerialPort } from '../host/serial_port.mjs';
import { request } from '../host/usb_host.mjs';

const IN = 0x80;

function board() {
  const made = new Board();
  made.powerOn();
  return { made, port: new SerialPort(made) };
}

/** Runs `body` with a plugged-in board; afterwards no rule may have been broken. */
function plugged(name, body, options = {}) {
  test(name, () => {
    const { made, port } = board();
    port.plugIn({ open: false, ...options });
    body(port.host, made, port);
    made.faults.assertNone();
  });
}

const deviceDescriptor = (length = 18) => request(IN, 6, 0x100, 0, length);

test('enumeration by a strict host: descriptors, address, strings, configuration', () => {
  const { made, port } = board();
  const { device, configuration, strings } = port.plugIn({ open: false }).read;
  assert.equal(device.vendor, 0x1209);
  assert.equal(strings.product, 'slamd IMU');
  assert.match(strings.serial, /^[0-9A-F]{16}$/);
  assert.deepEqual(configuration.interfaces.map((one) => one.class[0]), [2, 10, 255]);
  assert.deepEqual(configuration.interfaces[2].class, [255, 0, 1]);
  made.faults.assertNone();
});

test('endpoints in the controller are those of the descriptors, their buffers apart', () => {
  const { made, port } = board();
  port.plugIn({ open: false });
  const places = [];
  for (const { address, kind } of port.read.configuration.interfaces.flatMap((one) => one.endpoints)) {
    const described = port.host.port.buffers.describe(address & 15, address & 0x80 ? 0 : 1);
    assert.ok(described.enabled, `endpoint 0x${address.toString(16)}`);
    assert.equal(described.type, kind);
    places.push(described.at);
  }
  places.sort((a, b) => a - b).forEach((at, i) => assert.ok(i === 0 || at - places[i - 1] >= 64, 'buffers overlap'));
  made.faults.assertNone();
});

test('enumeration on a busy bus: the work-around of erratum RP2040-E5', () => {
  const { made, port } = board();
  port.plugIn({ open: false, busyBus: true });
  made.faults.assertNone();
});

plugged('a bus reset takes address and configuration away; it enumerates again under another address', (host, made, port) => {
  host.reset();
  assert.equal(host.controlIn(deviceDescriptor())[17], 1);
  assert.equal(host.controlIn(request(IN, 8, 0, 0, 1))[0], 0);
  setAddress(made, host, 93);
  host.controlOut(request(0, 9, 1));
  port.open();
});

plugged('ten bus resets in a row, some in the middle of a transfer', (host, made, port) => {
  for (let i = 0; i < 10; i += 1) {
    if (i % 2) host.abandon(deviceDescriptor());
    host.reset({ busyBus: i % 3 === 0 });
    assert.equal(host.controlIn(deviceDescriptor()).length, 18);
  }
  port.plugIn();
});

plugged('a new setup packet ends whatever transfer was under way', (host) => {
  host.abandon(request(IN, 6, 0x200, 0, 84));
  assert.equal(host.controlIn(deviceDescriptor()).length, 18);
  host.abandon(request(0x21, 0x20, 0, 0, 7));
  assert.equal(host.controlIn(deviceDescriptor()).length, 18);
  host.abandon(request(0, 5, 55));
  assert.equal(host.controlIn(deviceDescriptor()).length, 18, 'the address changes with the status stage only');
});

plugged('no answer is longer than asked for', (host) => {
  for (const length of [0, 1, 2, 8, 9, 17, 18, 19, 63, 64, 65, 255, 4096]) {
    assert.equal(host.controlIn({ ...deviceDescriptor(), length: Math.max(1, length) }).length, Math.min(18, Math.max(1, length)));
    const configuration = host.controlIn(request(IN, 6, 0x200, 0, Math.max(1, length)));
    assert.equal(configuration.length, Math.min(84, Math.max(1, length)));
  }
});

plugged('what it does not know it stalls, and goes on', (host) => {
  const unknown = [
    request(IN, 6, 0x600, 0, 10), // device qualifier: full speed only
    request(IN, 6, 0x700, 0, 9), request(IN, 6, 0x101, 0, 18), request(IN, 6, 0x201, 0, 9), request(IN, 6, 0x3f0, 0x409, 255),
    request(IN, 6, 0xf00, 0, 5), request(IN, 0x33, 0, 0, 4), request(0xc0, 1, 0, 0, 4), request(0xa1, 0x21, 0, 1, 7),
    request(0, 9, 2), request(0x40, 1, 0, 0), request(0x21, 0x77, 0, 0), request(0x21, 9, 0, 2),
    request(0x01, 11, 1, 0), request(0x01, 11, 0, 9), request(IN | 1, 10, 0, 7, 1), request(IN | 2, 0, 0, 0x85, 2),
  ];
  for (const setup of unknown) {
    assert.ok(host.stalls(setup), JSON.stringify(setup));
    assert.equal(host.controlIn(deviceDescriptor()).length, 18);
  }
});

plugged('status, interface and halt requests', (host, made, port) => {
  assert.deepEqual([...host.controlIn(request(IN, 0, 0, 0, 2))], [0, 0]);
  assert.deepEqual([...host.controlIn(request(IN | 1, 10, 0, 1, 1))], [0]);
  host.controlOut(request(1, 11, 0, 1));
  const endpoint = 0x80 | port.inEndpoint;
  host.controlOut(request(2, 3, 0, endpoint));
  assert.deepEqual([...host.controlIn(request(IN | 2, 0, 0, endpoint, 2))], [1, 0]);
  assert.equal(host.port.in(host.address, port.inEndpoint), 'stall');
  host.controlOut(request(2, 1, 0, endpoint));
  assert.deepEqual([...host.controlIn(request(IN | 2, 0, 0, endpoint, 2))], [0, 0]);
  host.controlOut(request(2, 3, 0, port.outEndpoint));
  assert.equal(host.rawOut(port.outEndpoint, 0, [0]), 'stall');
  host.controlOut(request(2, 1, 0, port.outEndpoint));
  host.resetOutToggle(port.outEndpoint);
  host.bulkOut(port.outEndpoint, [0]);
});

plugged('line coding is kept as it was set', (host, made, port) => {
  port.setLineCoding(921600);
  assert.deepEqual([...host.controlIn(request(0xa1, 0x21, 0, 0, 7))], [0x00, 0x10, 0x0e, 0x00, 0, 0, 8]);
  assert.equal(made.bootLoader, null);
});

plugged('it says nothing to other addresses and on endpoints it does not have', (host, made, port) => {
  assert.equal(host.port.in(host.address + 1, 0), 'timeout');
  assert.equal(host.port.in(host.address, 5), 'timeout');
  assert.equal(host.port.out(host.address, port.outEndpoint + 3, 0, new Uint8Array(1)), 'timeout');
});

plugged('suspend and resume: it is silent, then goes on under its address', (host, made, port) => {
  port.open();
  made.run(100 * MILLISECOND);
  host.suspend();
  made.run(500 * MILLISECOND);
  host.resume();
  assert.equal(host.controlIn(request(IN, 8, 0, 0, 1))[0], 1);
});
