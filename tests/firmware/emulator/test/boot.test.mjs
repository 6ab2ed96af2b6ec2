// Start of the firmware: second stage, clocks, serial number, sleep, double tap of reset, watchdog.
import assert from 'node:assert/strict';
import test from 'node:test';

import { Board, firmwareUnderTest, MILLISECOND, SECOND } from '../board/board.mjs';
import { SerialPort } from '../host/serial_port.mjs';

const PARKING = 0x20030000; // RAM that the firmware does not use
const BRANCH_TO_ITSELF = 0xe7fe;

function started(options) {
  const board = new Board(options);
  board.powerOn();
  return board;
}

/** The main loop never comes back; interrupts go on. */
function hangMainLoop(board) {
  const { core } = board.chip.rp2040;
  assert.ok(board.runUntil(() => core.IPSR === 0 && !core.PM, SECOND));
  board.chip.rp2040.writeUint16(PARKING, BRANCH_TO_ITSELF);
  core.PC = PARKING;
  core.waiting = false;
}

test('the second stage has the right checksum; with one bit flipped the ROM goes to its boot loader', () => {
  const image = firmwareUnderTest();
  assert.equal(started({ image }).bootLoader, null);
  const broken = Uint8Array.from(image);
  broken[17] ^= 4;
  assert.notEqual(started({ image: broken }).bootLoader, null);
});

test('crystal, 48 MHz from the USB PLL, a tick of 1 us, flash no faster than its data sheet', () => {
  const board = started();
  board.run(100 * MILLISECOND);
  const { rp2040, watchdog, flash } = board.chip;
  assert.equal(rp2040.clocks.refFreq, 12e6);
  assert.equal(rp2040.pllUsb.frequency, 48e6);
  const vco = (rp2040.xoscFreq * rp2040.pllUsb.fbdiv) / rp2040.pllUsb.refdiv;
  assert.ok(vco >= 750e6 && vco <= 1600e6, `VCO ${vco / 1e6} MHz`);
  assert.equal(watchdog.tickHz, 1e6);
  assert.ok(flash.clockAllowed || !flash.mapped, `flash at ${flash.clockHz / 1e6} MHz`);
  board.faults.assertNone();
});

test('within 100 ms of power it shows itself to the host, and its serial number is the flash chip\'s id', () => {
  const board = started({ flashId: [0x01, 0x23, 0x45, 0x67, 0x89, 0xab, 0xcd, 0xef] });
  const port = new SerialPort(board);
  assert.ok(port.host.waitForAttach(100 * MILLISECOND));
  assert.equal(port.plugIn().read.strings.serial, '0123456789ABCDEF');
  board.faults.assertNone();
});

test('the core sleeps nearly all the time, and the LED is driven', () => {
  const board = started();
  board.run(2 * SECOND);
  const { busyCycles, sleptCycles } = board.chip;
  assert.ok(busyCycles / (busyCycles + sleptCycles) < 0.2);
  assert.ok(board.ledChanges.length >= 2);
  board.faults.assertNone();
});

test('two taps of the reset button enter the boot loader, and the LED pin shows its activity', () => {
  const board = started();
  board.run(200 * MILLISECOND);
  board.tapReset();
  board.run(200 * MILLISECOND);
  assert.equal(board.bootLoader, null, 'one tap');
  board.tapReset();
  board.run(50 * MILLISECOND);
  assert.notEqual(board.bootLoader, null, 'two taps');
  assert.equal(board.bootLoader.activityPins, 1 << 6);
  assert.equal(board.bootLoader.disabledInterfaces, 0);
});

test('taps of the reset button a second and more apart only reset', () => {
  const board = started();
  for (let i = 0; i < 3; i += 1) {
    board.run(1.2 * SECOND);
    board.tapReset();
    board.run(100 * MILLISECOND);
    assert.equal(board.bootLoader, null);
  }
  assert.deepEqual(board.resets.map((reset) => reset.cause), ['power', 'button', 'button', 'button']);
});

test('after power the memory holds anything: one tap is not taken for two', () => {
  const board = started();
  board.run(10 * MILLISECOND);
  assert.equal(board.bootLoader, null);
});

test('a main loop that hangs is bitten by the watchdog within 2 s, and the board comes back', () => {
  const board = started();
  const port = new SerialPort(board).plugIn();
  hangMainLoop(board);
  const hungAt = board.world.now;
  assert.ok(board.runUntil(() => board.resets.length === 2, 2 * SECOND));
  assert.equal(board.resets[1].cause, 'watchdog timer');
  assert.ok(board.resets[1].at - hungAt > 10 * MILLISECOND);
  port.plugIn();
  board.faults.assertNone();
});

test('a watchdog reset between two taps of the button is not a tap', () => {
  const board = started();
  board.run(1.2 * SECOND);
  board.tapReset();
  board.run(100 * MILLISECOND);
  hangMainLoop(board);
  assert.ok(board.runUntil(() => board.resets.length === 3, 2 * SECOND));
  board.run(100 * MILLISECOND);
  assert.equal(board.bootLoader, null);
});
