// Ways out of the running firmware, and bytes into it: reset interface, 1200-baud touch, bulk OUT.
import assert from 'node:assert/strict';
import test from 'node:test';

import { Board, MILLISECOND, SECOND } from '../board/board.mjs';
import { SerialPort } from '../host/serial_port.mjs';
import { request } from '../host/usb_host.mjs';

const RESET_TO_INTERFACE = 0x21;

/** Runs `body` with a plugged-in board; afterwards no rule may have been broken. */
function plugged(name, body) {
  test(name, () => {
    const made = new Board();
    made.powerOn();
    const port = new SerialPort(made).plugIn({ open: false });
    body(port.host, made, port);
    made.faults.assertNone();
  });
}

plugged('bulk OUT: packets with due toggles are taken, also many and empty ones; a repeated one is acknowledged', (host, made, port) => {
  for (let i = 0; i < 20; i += 1) host.bulkOut(port.outEndpoint, new Array(1 + (i * 13) % 64).fill(0));
  made.run(2 * MILLISECOND);
  assert.equal(host.rawOut(port.outEndpoint, 1, [0, 0]), 'ack'); // the last one once more: its toggle is not due
  host.bulkOut(port.outEndpoint, [0, 0]);
  assert.equal(made.bootLoader, null);
});

plugged('the reset interface starts the firmware again', (host, made, port) => {
  host.controlOut(request(RESET_TO_INTERFACE, 2, 0, 2));
  assert.ok(made.runUntil(() => made.resets.length === 2, SECOND));
  assert.equal(made.resets[1].cause.startsWith('watchdog'), true);
  port.plugIn();
  assert.equal(made.bootLoader, null);
});

plugged('the reset interface enters the boot loader', (host, made) => {
  host.controlOut(request(RESET_TO_INTERFACE, 1, 0, 2));
  assert.ok(made.runUntil(() => made.bootLoader !== null, SECOND));
  assert.equal(made.bootLoader.disabledInterfaces, 0);
});

plugged('1200 baud and a closed port enter the boot loader; closing at any other rate does not', (host, made, port) => {
  port.setLineState(3);
  port.setLineCoding(9600);
  port.setLineState(0);
  made.run(500 * MILLISECOND);
  assert.equal(made.bootLoader, null);
  port.setLineCoding(1200);
  port.setLineState(3);
  port.setLineState(0);
  assert.ok(made.runUntil(() => made.bootLoader !== null, SECOND));
  assert.ok(!host.attached, 'it has left the bus');
});
