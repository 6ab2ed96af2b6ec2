// Commands from the host: each one, and what is no command.
import assert from 'node:assert/strict';
import test from 'node:test';

import { Board, MILLISECOND, SECOND } from '../board/board.mjs';
import { lively } from '../board/motions.mjs';
import { command } from '../host/packets.mjs';
import { COMMAND, SerialPort } from '../host/serial_port.mjs';

const RESULT = { accepted: 0, unknown: 1 };
const OUTCOME = { passed: 0, failed: 1 };
const WATCHDOG_RESET = 16;
const FIRST_FRAME = 32;

function running() {
  const board = new Board({ flashId: [0xe4, 0x62, 0x5c, 0x00, 0x03, 0x9b, 0x2f, 0xff] });
  board.powerOn();
  const port = new SerialPort(board).plugIn();
  assert.ok(port.waitFor((packet) => packet.kind === 'sample'), 'no sample');
  return { board, port };
}

test('identity: unique id, version, sensor, ranges', () => {
  const { board, port } = running();
  const identity = port.ask(COMMAND.identity);
  assert.equal(identity.kind, 'identity');
  assert.equal(identity.sensorId, 0x6c);
  assert.deepEqual(identity.uniqueId, [0xe4, 0x62, 0x5c, 0x00, 0x03, 0x9b, 0x2f, 0xff]);
  assert.deepEqual([identity.rateHz, identity.gyroDps, identity.accelG], [208, 500, 4]);
  assert.equal(identity.chipRevision, 1);
  const release = port.read.device.release;
  assert.deepEqual([release >> 8, (release >> 4) & 15, release & 15], identity.version, 'bcdDevice is the version');
  board.faults.assertNone();
});

test('statistics agree with the stream', () => {
  const { board, port } = running();
  board.run(2 * SECOND);
  const statistics = port.ask(COMMAND.statistics);
  const newest = port.reader.last('sample');
  assert.equal(statistics.state, 1);
  assert.ok(Math.abs(statistics.samples - newest.sequence) <= 2, `${statistics.samples} samples, sequence ${newest.sequence}`);
  assert.ok(Math.abs(statistics.deviceUs - newest.deviceUs) < 10e3);
  assert.equal(statistics.resetCause, 0);
  assert.equal(statistics.usbResets, 2);
  assert.deepEqual([statistics.overruns, statistics.faults, statistics.badCommands], [0, 0, 0]);
});

test('self-test passes on a good sensor, and samples come again in the right scale', () => {
  const { board, port } = running();
  const report = port.ask(COMMAND.selfTest, 5 * SECOND);
  assert.equal(report.kind, 'selfTest');
  assert.deepEqual([report.outcome, report.failedAxes], [OUTCOME.passed, 0]);
  for (const axis of report.accelMg) assert.ok(Math.abs(Math.abs(axis) - 700) < 5, `${axis} mg`);
  for (const axis of report.gyroDdps) assert.ok(Math.abs(Math.abs(axis) - 4000) < 30, `${axis / 10} dps`);
  assert.ok(port.waitFor((packet) => packet.kind === 'sample' && packet.status === 0, 2 * SECOND));
  const [sample] = port.collect(20 * MILLISECOND);
  assert.ok(Math.abs(sample.accel[2] - 1000 / 0.122) < 1);
  board.faults.assertNone();
});

test('self-test fails on a sensor whose self-test does nothing', () => {
  const { board, port } = running();
  board.sensor.selfTestWorks = false;
  const report = port.ask(COMMAND.selfTest, 5 * SECOND);
  assert.deepEqual([report.outcome, report.failedAxes], [OUTCOME.failed, 0b111111]);
  assert.ok(port.waitFor((packet) => packet.kind === 'sample' && packet.status === 0, 2 * SECOND));
});

test('reset: acknowledged, then the board starts anew and says that it did', () => {
  const { board, port } = running();
  assert.equal(port.ask(COMMAND.reset)?.result, RESULT.accepted);
  assert.ok(board.runUntil(() => board.resets.length === 2, SECOND));
  port.reader.packets.length = 0;
  port.plugIn();
  assert.ok(port.waitFor((packet) => packet.kind === 'sample', 3 * SECOND));
  assert.equal(port.ask(COMMAND.statistics).resetCause, 2);
  assert.equal(port.reader.last('sample').status & WATCHDOG_RESET, 0, 'asked for, not bitten');
  board.faults.assertNone();
});

test('boot loader: acknowledged, then entered', () => {
  const { board, port } = running();
  assert.equal(port.ask(COMMAND.bootLoader)?.result, RESULT.accepted);
  assert.ok(board.runUntil(() => board.bootLoader !== null, SECOND));
});

test('an unknown command is answered as such', () => {
  const { port } = running();
  const answer = port.ask(99);
  assert.deepEqual([answer?.kind, answer?.code, answer?.result], ['acknowledgement', 99, RESULT.unknown]);
});

test('garbage is counted and ignored; the command after it is obeyed', () => {
  const { board, port } = running();
  const { outEndpoint, host } = port;
  let seed = 1;
  const random = () => {
    seed = (seed * 1103515245 + 12345) & 0x7fffffff;
    return (seed >> 16) & 0xff;
  };
  for (let i = 0; i < 40; i += 1) host.bulkOut(outEndpoint, Array.from({ length: 64 }, random));
  host.bulkOut(outEndpoint, [0]);
  const damaged = command(COMMAND.reset, 7);
  damaged[5] ^= 0x55;
  host.bulkOut(outEndpoint, damaged);
  host.bulkOut(outEndpoint, [...command(COMMAND.identity, 500), ...command(COMMAND.statistics, 501)]);
  board.run(100 * MILLISECOND);
  const tags = port.reader.packets.filter((packet) => packet.tag >= 500).map((packet) => packet.tag);
  assert.deepEqual(tags, [500, 501]);
  assert.ok(port.ask(COMMAND.statistics).badCommands > 0);
  assert.equal(board.resets.length, 1);
  assert.equal(board.bootLoader, null);
  board.faults.assertNone();
});

test('a command cut into single bytes is understood', () => {
  const { board, port } = running();
  for (const byte of command(COMMAND.identity, 321)) port.host.bulkOut(port.outEndpoint, [byte]);
  board.run(100 * MILLISECOND);
  assert.equal(port.reader.last('identity')?.tag, 321);
});

test('a watchdog bite is told in the stream', () => {
  const board = new Board();
  board.sensor.motion = lively;
  board.powerOn();
  const port = new SerialPort(board).plugIn();
  assert.ok(port.waitFor((packet) => packet.kind === 'sample'));
  const { core } = board.chip.rp2040;
  assert.ok(board.runUntil(() => core.IPSR === 0 && !core.PM, SECOND));
  board.chip.rp2040.writeUint16(0x20030000, 0xe7fe);
  core.PC = 0x20030000;
  core.waiting = false;
  assert.ok(board.runUntil(() => board.resets.length === 2, 3 * SECOND));
  port.reader.packets.length = 0;
  port.plugIn();
  assert.ok(port.waitFor((packet) => packet.kind === 'sample' && packet.status & WATCHDOG_RESET, 3 * SECOND));
  assert.equal(port.ask(COMMAND.statistics).resetCause, 1);
  const first = port.reader.packets.filter((packet) => packet.kind === 'sample' && packet.status & FIRST_FRAME);
  assert.ok(first.length <= 1);
});
