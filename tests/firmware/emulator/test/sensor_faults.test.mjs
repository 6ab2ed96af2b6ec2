// A sensor that is missing, is another one, hangs the bus, falls silent or is reset: told in the stream, recovered from.
import assert from 'node:assert/strict';
import test from 'node:test';

import { Board, MILLISECOND, SECOND } from '../board/board.mjs';
import { lively } from '../board/motions.mjs';
import { COMMAND, SerialPort } from '../host/serial_port.mjs';
import { match, worstCounts } from '../host/stamps.mjs';

const STATE = { running: 1 };
const FAULT = { noAnswer: 1, wrongId: 2, busHung: 3, configuration: 4, noData: 5 };
const SENSOR_FAULT = 8;

const isSample = (packet) => packet.kind === 'sample' && !(packet.status & SENSOR_FAULT);
const isFault = (packet) => packet.kind === 'sample' && (packet.status & SENSOR_FAULT) !== 0;

function plugged(prepare = () => {}) {
  const board = new Board();
  board.sensor.motion = lively;
  board.powerOn();
  prepare(board.sensor);
  return { board, port: new SerialPort(board).plugIn() };
}

/** The stream tells the fault in its frames, and the statistics say which. */
function assertTold(board, port, fault) {
  assert.ok(port.waitFor(isFault, 2 * SECOND), 'no frame with the sensor\'s fault');
  let statistics;
  for (let i = 0; i < 20 && statistics?.fault !== fault; i += 1) {
    statistics = port.ask(COMMAND.statistics);
    board.run(100 * MILLISECOND);
  }
  assert.deepEqual([statistics.state === STATE.running, statistics.fault], [false, fault]);
}

/** Good samples again, with the right scale: the sensor has been set up anew. */
function assertRecovers(board, port, nanos = 3 * SECOND) {
  assert.ok(port.waitFor(isSample, nanos), 'no samples again');
  const samples = port.collect(SECOND);
  assert.ok(samples.length > 200, `${samples.length} samples in a second`);
  for (const { sample, measured, errorUs } of match(board, samples)) {
    assert.equal(sample.status & SENSOR_FAULT, 0);
    assert.ok(worstCounts(sample, lively(measured.at / 1e9)) < 0.51, JSON.stringify(sample));
    assert.ok(Math.abs(errorUs) < 2);
  }
  const statistics = port.ask(COMMAND.statistics);
  assert.equal(statistics.state, STATE.running);
  assert.ok(statistics.loopMaxUs < 1000, `a pass of the loop took ${statistics.loopMaxUs} us`);
  assert.deepEqual(port.reader.bad, []);
  board.faults.assertNone();
}

/** Runs until the sensor is in the middle of a transfer. */
function inTransfer(board) {
  const before = board.chip.i2c.transfers;
  assert.ok(board.runUntil(() => board.chip.i2c.transfers > before, SECOND));
  board.run(0.15 * MILLISECOND);
}

test('missing at power-on, plugged in later', () => {
  const { board, port } = plugged((sensor) => sensor.powerOff());
  assertTold(board, port, FAULT.noAnswer);
  board.run(2 * SECOND);
  board.sensor.powerOn();
  assertRecovers(board, port);
});

test('lost while running, and back', () => {
  const { board, port } = plugged();
  assert.ok(port.waitFor(isSample));
  board.sensor.powerOff();
  assertTold(board, port, FAULT.noAnswer);
  board.run(SECOND);
  board.sensor.powerOn();
  assertRecovers(board, port);
});

test('another sensor at its address', () => {
  const { board, port } = plugged((sensor) => {
    sensor.whoAmI = 0x6a;
  });
  assertTold(board, port, FAULT.wrongId);
  assert.equal(port.ask(COMMAND.identity).sensorId, 0x6a);
  assert.equal(port.reader.packets.filter(isSample).length, 0);
  board.sensor.whoAmI = 0x6c;
  assertRecovers(board, port);
});

test('SDA held low at power-on: nine clocks free it', () => {
  const { board, port } = plugged((sensor) => sensor.hang(9));
  assertRecovers(board, port);
  assert.ok(board.bus.pulses >= 9);
});

test('SDA held low in the middle of a transfer: told, nine clocks free it', () => {
  const { board, port } = plugged();
  assert.ok(port.waitFor(isSample));
  inTransfer(board);
  board.sensor.hang(9);
  assertTold(board, port, FAULT.busHung);
  assertRecovers(board, port);
  assert.equal(port.ask(COMMAND.statistics).busRecoveries, 1, 'at the first attempt');
});

test('SDA held low between transfers', () => {
  const { board, port } = plugged();
  assert.ok(port.waitFor(isSample));
  board.run(2 * MILLISECOND);
  board.sensor.hang(9);
  assertRecovers(board, port);
});

test('SDA held low for good: told, tried again and again, well when it is let go', () => {
  const { board, port } = plugged();
  assert.ok(port.waitFor(isSample));
  board.sensor.hang(Infinity);
  assertTold(board, port, FAULT.busHung);
  board.run(3 * SECOND);
  assert.equal(board.resets.length, 1, 'without a reset');
  assert.ok(port.ask(COMMAND.statistics).busRecoveries >= 2);
  board.sensor.release();
  assertRecovers(board, port);
});

test('data-ready stops', () => {
  const { board, port } = plugged();
  assert.ok(port.waitFor(isSample));
  board.sensor.dataReadyWorks = false;
  assertTold(board, port, FAULT.noData);
  board.run(SECOND);
  board.sensor.dataReadyWorks = true;
  assertRecovers(board, port);
});

test('the sensor alone restarts and forgets its configuration', () => {
  const { board, port } = plugged();
  assert.ok(port.waitFor(isSample));
  board.sensor.powerOn();
  assertRecovers(board, port);
});

test('reset with data-ready already high: the stream starts all the same', () => {
  const { board, port } = plugged();
  assert.ok(port.waitFor(isSample));
  assert.ok(board.runUntil(() => board.sensor.dataReady, SECOND));
  board.tapReset();
  board.run(50 * MILLISECOND);
  port.plugIn();
  assertRecovers(board, port);
});

test('a fault shows on the LED', () => {
  const { board, port } = plugged();
  assert.ok(port.waitFor(isSample));
  const changes = () => {
    const from = board.ledChanges.length;
    board.run(4 * SECOND);
    return board.ledChanges.length - from;
  };
  const well = changes();
  board.sensor.powerOff();
  board.run(SECOND);
  assert.notEqual(changes(), well);
});
