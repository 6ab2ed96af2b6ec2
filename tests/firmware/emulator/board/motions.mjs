// Motions for the sensor model: every axis moves in its own way, so that no two can be taken for each other.

const GRAVITY = 9.80665;

/** Smooth, all axes different, within +-500 dps and +-4 g. SI. */
export function lively(seconds) {
  const wave = (hertz, phase) => Math.sin(2 * Math.PI * hertz * seconds + phase);
  return {
    gyro: [0.6 * wave(0.7, 0) + 0.3, 1.1 * wave(1.1, 1) - 0.4, 2.0 * wave(0.4, 2) + 0.1],
    accel: [3 * wave(0.9, 3) + 0.8, 2 * wave(1.3, 4) - 1.5, GRAVITY + 4 * wave(0.6, 5)],
    temperature: 25 + 8 * wave(0.05, 0),
  };
}

/** Constant; every axis another value and sign. */
export const constant = () => ({ gyro: [0.5, -1.25, 3.0], accel: [1.5, -6.25, 9.5], temperature: 36.5 });

/** Beyond the ranges of gyroscope z and accelerometer x for one second in two. */
export function clipping(seconds) {
  const beyond = Math.floor(seconds) % 2 === 1;
  return { gyro: [0, 0, beyond ? 11 : 1], accel: [beyond ? -45 : -1, 0, GRAVITY], temperature: 25 };
}
