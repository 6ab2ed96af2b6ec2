// The stream of samples: values, scale, order, time stamps, back-pressure, load and latency.
import assert from 'node:assert/strict';
import test from 'node:test';

import { Board, MILLISECOND, SECOND } from '../board/board.mjs';
import { clipping, constant, lively } from '../board/motions.mjs';
import { request } from '../host/usb_host.mjs';
import { COMMAND, SerialPort } from '../host/serial_port.mjs';
import { match, worstCounts } from '../host/stamps.mjs';

const STATUS = { overrun: 1, gyroClipped: 2, accelClipped: 4, sensorFault: 8, watchdogReset: 16, firstFrame: 32 };
const STAMP_US = 2;

function streaming({ motion = lively, rateError = 0 } = {}) {
  const board = new Board();
  board.sensor.motion = motion;
  board.sensor.rateError = rateError;
  board.powerOn();
  const port = new SerialPort(board).plugIn();
  assert.ok(port.waitFor((packet) => packet.kind === 'sample'), 'no sample');
  return { board, port };
}

function assertConsecutive(samples) {
  for (let i = 1; i < samples.length; i += 1) {
    assert.equal(samples[i].sequence, (samples[i - 1].sequence + 1) & 0xffff, `after ${samples[i - 1].sequence}`);
  }
}

function assertStampsTrue(board, samples) {
  for (const { sample, errorUs } of match(board, samples)) {
    assert.ok(errorUs > -STAMP_US && errorUs < STAMP_US, `sequence ${sample.sequence}: stamp off by ${errorUs.toFixed(2)} us`);
  }
}

function assertWell(board, port) {
  board.faults.assertNone();
  assert.deepEqual(port.reader.bad, []);
}

function quantile(values, share) {
  return [...values].sort((a, b) => a - b)[Math.floor(share * (values.length - 1))];
}

test('10 s of samples at 208 Hz: each one, in order, as measured, stamped within 2 us', () => {
  const { board, port } = streaming();
  const samples = port.collect(10 * SECOND);
  assert.ok(Math.abs(samples.length - 2080) <= 2, `${samples.length} samples`);
  assertConsecutive(samples);
  assertStampsTrue(board, samples);
  for (const { sample, measured } of match(board, samples)) {
    assert.deepEqual([sample.gyro, sample.accel, sample.temperature, sample.status, sample.dropped],
      [measured.gyro, measured.accel, measured.temperature, 0, samples[0].dropped]);
  }
  assertWell(board, port);
});

test('values in SI units are those of the motion: order of registers, byte order, scale', () => {
  for (const motion of [constant, lively]) {
    const { board, port } = streaming({ motion });
    const samples = port.collect(SECOND);
    assert.ok(samples.length > 200);
    for (const { sample, measured } of match(board, samples)) {
      assert.ok(worstCounts(sample, motion(measured.at / 1e9)) < 0.51, JSON.stringify(sample));
    }
    assertWell(board, port);
  }
});

test('the sensor is set up as the wire format promises', () => {
  const { board } = streaming();
  const register = (address) => board.sensor.register(address);
  assert.equal(register(0x10) & 0xfc, 0x58, 'accelerometer 208 Hz, +-4 g');
  assert.equal(register(0x11) & 0xfe, 0x54, 'gyroscope 208 Hz, +-500 dps');
  assert.equal(register(0x12) & 0x44, 0x44, 'block data update, addresses advance');
  assert.equal(register(0x12) & 0x30, 0, 'data-ready active high, push-pull');
  assert.notEqual(register(0x0d) & 0x03, 0, 'data-ready on INT1');
  assert.equal(register(0x14) & 0x0f, 0, 'no self-test');
});

test('the rate is the sensor\'s own: an oscillator off by 3 % is seen in the stamps, not hidden', () => {
  const { board, port } = streaming({ rateError: 0.03 });
  const samples = port.collect(2 * SECOND);
  const seconds = (samples.at(-1).deviceUs - samples[0].deviceUs) / 1e6;
  assert.ok(Math.abs((samples.length - 1) / seconds - 208 * 1.03) < 0.01);
  assertConsecutive(samples);
  assertStampsTrue(board, samples);
});

test('an axis at the end of its range is flagged, and only then', () => {
  const { board, port } = streaming({ motion: clipping });
  const flags = STATUS.gyroClipped | STATUS.accelClipped;
  let clipped = 0;
  for (const sample of port.collect(4 * SECOND)) {
    const atEnd = sample.gyro[2] === 32767;
    assert.equal(sample.status, atEnd ? flags : 0);
    clipped += atEnd ? 1 : 0;
  }
  assert.ok(clipped > 380 && clipped < 450, `${clipped} clipped`);
  assertWell(board, port);
});

test('only the first frame after a start says so, also when the host comes late', () => {
  const board = new Board();
  board.powerOn();
  board.run(3 * SECOND);
  const port = new SerialPort(board).plugIn();
  const samples = port.collect(SECOND);
  const marked = port.reader.samples.filter((sample) => sample.status & STATUS.firstFrame);
  assert.ok(marked.length <= 1);
  assert.ok(samples.length > 200);
  assertConsecutive(samples);
  assertWell(board, port);
});

test('a host that does not read for 3 s: sampling goes on, what is lost is counted, the stream goes on', () => {
  const { board, port } = streaming();
  const before = port.collect(SECOND).at(-1);
  port.stopReading();
  board.run(3 * SECOND);
  port.startReading();
  const after = port.collect(SECOND);
  const received = port.reader.samples;
  const last = after.at(-1);
  const sent = received.filter((sample) => sample.sequence > before.sequence && sample.sequence <= last.sequence).length;
  const lost = last.sequence - before.sequence - sent;
  assert.ok(lost > 400, `${lost} frames lost`);
  assert.equal(last.dropped - before.dropped, lost, 'dropped says how many');
  assert.ok(Math.abs(last.deviceUs - before.deviceUs - ((last.sequence - before.sequence) * 1e6) / 208) < 10);
  assertConsecutive(after.slice(-150));
  assertStampsTrue(board, received);
  assert.ok(received.every((sample) => !(sample.status & STATUS.overrun)), 'no sample was missed at the sensor');
  assertWell(board, port);
});

test('a port closed and opened again gives fresh samples', () => {
  const { board, port } = streaming();
  board.run(SECOND);
  port.close();
  board.run(2 * SECOND);
  const closed = port.reader.packets.length;
  port.open();
  board.run(SECOND);
  const first = port.reader.packets.slice(closed).find((packet) => packet.kind === 'sample');
  const ageMs = (first.at - match(board, [first])[0].measured.at) / 1e6;
  assert.ok(ageMs < 200, `the first sample is ${ageMs.toFixed(1)} ms old`);
  assertConsecutive(port.collect(SECOND));
});

test('stamps stay true while the host asks for everything at once', () => {
  const { board, port } = streaming();
  const from = port.reader.packets.length;
  for (let i = 0; i < 300; i += 1) {
    assert.ok(port.ask(i % 2 ? COMMAND.identity : COMMAND.statistics));
    port.host.controlIn(request(0x80, 6, 0x200, 0, 84));
    port.setLineCoding(115200 + i);
    board.run((i % 7) * MILLISECOND);
  }
  const samples = port.reader.packets.slice(from).filter((packet) => packet.kind === 'sample');
  assert.ok(samples.length > 200);
  assertConsecutive(samples);
  assertStampsTrue(board, samples);
  assertWell(board, port);
});

test('stamps go on when the lower half of the timer wraps, after 71 minutes', () => {
  const board = new Board({ timerStart: 2 ** 32 - 1.5e6 });
  board.sensor.motion = lively;
  board.powerOn();
  const port = new SerialPort(board).plugIn();
  const samples = port.collect(3 * SECOND);
  assert.ok(samples[0].deviceUs < 2 ** 32 && samples.at(-1).deviceUs > 2 ** 32 + 1e6);
  assertConsecutive(samples);
  assertStampsTrue(board, samples);
  assertWell(board, port);
});

test('suspend and resume: sampling went on, the stream goes on', () => {
  const { board, port } = streaming();
  const before = port.collect(SECOND).at(-1);
  port.host.suspend();
  board.run(SECOND);
  port.host.resume();
  const after = port.collect(SECOND);
  assert.ok(after.at(-1).sequence - before.sequence > 400);
  assertConsecutive(after.slice(-150));
  assertStampsTrue(board, after);
  assertWell(board, port);
});

test('cost at 208 Hz: processor load and latency from data-ready to the host', (t) => {
  const { board, port } = streaming();
  const { busyCycles, sleptCycles } = board.chip;
  const samples = port.collect(5 * SECOND);
  const busy = board.chip.busyCycles - busyCycles;
  const load = busy / (busy + board.chip.sleptCycles - sleptCycles);
  const latencies = match(board, samples).map(({ sample, measured }) => (sample.at - measured.at) / 1000);
  const { latencyMaxUs, loopMaxUs } = port.ask(COMMAND.statistics);
  t.diagnostic(`load ${(100 * load).toFixed(2)} % of ${board.chip.rp2040.clkSys / 1e6} MHz, ${Math.round(busy / samples.length)} cycles a sample`);
  t.diagnostic(`data-ready to host: median ${quantile(latencies, 0.5).toFixed(0)} us, p99 ${quantile(latencies, 0.99).toFixed(0)} us, worst `
    + `${Math.max(...latencies).toFixed(0)} us; its own: ${latencyMaxUs} us to the queue, longest pass of the loop ${loopMaxUs} us`);
  assert.ok(load < 0.25);
  assert.ok(Math.max(...latencies) < 2000);
  assert.ok(loopMaxUs < 1000, 'no wait longer than 1 ms');
});
