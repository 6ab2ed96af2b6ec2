// A motion for the sensor model from a file of slam-sim --imu-motion (exact, CLOCK_MONOTONIC), with the noise and biases of
// a real LSM6DSOX added. Sampled once a call: made for one sensor.
import { readFileSync } from 'node:fs';

const GRAVITY = 9.80665;
const RAD_PER_DEGREE = Math.PI / 180;
// Data sheet DS12814, table 3; as ImuModel of slam-sim.
const NOISE = { gyro: 3.8e-3 * RAD_PER_DEGREE, accel: 70e-6 * GRAVITY }; // densities
const BIAS = { gyro: 0.3 * RAD_PER_DEGREE, accel: 8e-3 * GRAVITY }; // standard deviations at power-on
const BANDWIDTH_HZ = 104;
const HALF_PERIOD_NS = 2.4e6; // a sample is the mean over its period

/** Normal numbers, the same for the same seed. */
function normals(seed) {
  let state = seed >>> 0;
  const uniform = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state + 0.5) / 2 ** 32;
  };
  return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

export class RecordedMotion {
  #rows; // gx gy gz ax ay az
  #startNs; // a BigInt: nanoseconds of the host do not fit a double exactly
  #normal;
  #bias;

  constructor(path, seed = 1) {
    const lines = readFileSync(path, 'utf8').trimEnd().split('\n').slice(1);
    this.#startNs = BigInt(lines[0].split(',')[0]);
    this.#rows = lines.map((line) => line.split(',').slice(1).map(Number));
    this.#normal = normals(seed);
    const three = (sigma) => [0, 1, 2].map(() => sigma * this.#normal());
    this.#bias = [...three(BIAS.gyro), ...three(BIAS.accel)];
  }

  get startNs() {
    return this.#startNs;
  }

  get endNs() {
    return this.#startNs + BigInt(this.#rows.length - 1) * 1000000n;
  }

  /** What a sensor would measure at a host time; before the start and after the end the vehicle stands as it does there. */
  at(hostNs) {
    const milliseconds = Number(hostNs - this.#startNs) / 1e6;
    const taps = [-0.75, -0.25, 0.25, 0.75].map((tap) => this.#row(milliseconds + (tap * HALF_PERIOD_NS) / 1e6));
    const measured = this.#bias.map((bias, axis) => {
      const mean = taps.reduce((sum, row) => sum + row[axis], 0) / taps.length;
      const density = axis < 3 ? NOISE.gyro : NOISE.accel;
      return mean + bias + density * Math.sqrt(BANDWIDTH_HZ) * this.#normal();
    });
    return { gyro: measured.slice(0, 3), accel: measured.slice(3), temperature: 31 };
  }

  /** Linear between the rows. */
  #row(milliseconds) {
    const place = Math.max(0, Math.min(this.#rows.length - 1, milliseconds));
    const index = Math.min(Math.floor(place), this.#rows.length - 2);
    const share = place - index;
    return this.#rows[index].map((value, axis) => value + share * (this.#rows[index + 1][axis] - value));
  }
}
