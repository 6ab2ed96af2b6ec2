// The register model by itself: what the firmware's tests stand on.
import assert from 'node:assert/strict';
import test from 'node:test';

import { Lsm6dsox } from '../board/lsm6dsox.mjs';
import { World } from '../chip/world.mjs';

function sensor() {
  const world = new World();
  const model = new Lsm6dsox(world);
  world.advanceTo(11e6);
  const write = (address, ...values) => {
    assert.ok(model.start(false));
    for (const byte of [address, ...values]) model.write(byte);
    model.stop();
  };
  const read = (address, count) => {
    assert.ok(model.start(false));
    model.write(address);
    assert.ok(model.start(true));
    return Array.from({ length: count }, () => model.read());
  };
  return { world, model, write, read };
}

const int16 = (bytes, at) => ((bytes[at] | (bytes[at + 1] << 8)) << 16) >> 16;

test('it does not answer in its first 10 ms, then with its id', () => {
  const model = new Lsm6dsox(new World());
  assert.equal(model.start(false), false);
  assert.deepEqual(sensor().read(0x0f, 1), [0x6c]);
});

test('a burst gives temperature, gyroscope, accelerometer, little-endian, in the configured scale', () => {
  const { world, model, write, read } = sensor();
  model.motion = () => ({ gyro: [0.1, -0.2, 0.3], accel: [1, -2, 9], temperature: 30 });
  write(0x10, 0x58); // 208 Hz, 4 g
  write(0x11, 0x54); // 208 Hz, 500 dps
  world.advanceTo(world.now + 6e6);
  const bytes = read(0x20, 14);
  const counts = [0, 2, 4, 6, 8, 10, 12].map((at) => int16(bytes, at));
  const gyro = [0.1, -0.2, 0.3].map((rate) => Math.round((rate * 180) / Math.PI / 0.0175));
  const accel = [1, -2, 9].map((force) => Math.round(force / 9.80665 / 0.000122));
  assert.deepEqual(counts, [5 * 256, ...gyro, ...accel]);
});

test('data-ready rises with the sample and stays until it has been read', () => {
  const { world, model, write, read } = sensor();
  const edges = [];
  model.onDataReady((level) => edges.push([level, world.now]));
  write(0x0d, 0x02);
  const started = world.now;
  write(0x11, 0x54);
  world.advanceTo(started + 20e6); // four periods, none read: one edge
  assert.equal(edges.length, 1);
  assert.ok(Math.abs(edges[0][1] - started - 1e9 / 208) < 1);
  read(0x20, 14);
  assert.equal(model.dataReady, false);
  world.advanceTo(world.now + 5e6);
  assert.equal(model.dataReady, true);
});

test('in pulsed mode every sample gives an edge', () => {
  const { world, model, write } = sensor();
  let edges = 0;
  model.onDataReady((level) => (edges += level ? 1 : 0));
  write(0x0b, 0x80);
  write(0x0d, 0x02);
  write(0x11, 0x54);
  world.advanceTo(world.now + 48.2e6);
  assert.equal(edges, 10);
});

test('with block data update a sample is never torn, without it may be', () => {
  for (const blocked of [true, false]) {
    const { world, model, write } = sensor();
    let rate = 0.0;
    model.motion = () => ({ gyro: [(rate += 1) % 2 ? 0.1 : -0.1, 0, 0], accel: [0, 0, 0] });
    write(0x12, blocked ? 0x44 : 0x04);
    write(0x11, 0x54);
    world.advanceTo(world.now + 6e6);
    model.start(false);
    model.write(0x22);
    model.start(true);
    const low = model.read();
    world.advanceTo(world.now + 5e6);
    const counts = int16([low, model.read()], 0);
    assert.equal(Math.abs(counts) === 327, blocked);
  }
});

test('self-test shifts the outputs within the limits of the data sheet', () => {
  const { world, write, read } = sensor();
  write(0x10, 0x58);
  write(0x11, 0x5c); // 2000 dps
  write(0x14, 0x05); // both, positive
  world.advanceTo(world.now + 6e6);
  const bytes = read(0x20, 14);
  assert.ok(Math.abs(int16(bytes, 2) * 0.07 - 400) < 0.1);
  assert.ok(Math.abs(int16(bytes, 8) * 0.122 - 700) < 0.2);
});

test('software reset restores the registers', () => {
  const { world, write, read } = sensor();
  write(0x11, 0x54);
  write(0x12, 0x01);
  world.advanceTo(world.now + 1e6);
  assert.deepEqual(read(0x10, 3), [0, 0, 4]);
});

test('a held SDA line is let go after as many clock pulses as asked', () => {
  const { model } = sensor();
  model.hang(9);
  for (let i = 0; i < 8; i += 1) model.clockPulse();
  assert.ok(model.holdsSda);
  model.clockPulse();
  assert.ok(!model.holdsSda);
});
