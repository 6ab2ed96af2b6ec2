// Holds samples from the stream against what the sensor model measured: values, order, time stamps.

const GYRO_RAD_PER_COUNT = (17.5e-3 * Math.PI) / 180;
const ACCEL_MPS2_PER_COUNT = 0.122e-3 * 9.80665;

/** Device time (us) of a moment of true time, by the chip's running tick. */
export function deviceMicros(board, atNanos) {
  return board.chip.watchdog.ticks() - (board.world.now - atNanos) / 1000;
}

/** For each sample of the stream the model's sample of its stamp: { sample, measured, errorUs }. */
export function match(board, samples) {
  const measured = board.sensor.samples;
  return samples.map((sample) => {
    const atNanos = board.world.now - (board.chip.watchdog.ticks() - sample.deviceUs) * 1000;
    let low = 0;
    let high = measured.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (measured[middle].at <= atNanos) low = middle;
      else high = middle;
    }
    const nearest = Math.abs(measured[low].at - atNanos) < Math.abs(measured[high].at - atNanos) ? low : high;
    return { sample, index: nearest, measured: measured[nearest], errorUs: sample.deviceUs - deviceMicros(board, measured[nearest].at) };
  });
}

/** The sample in SI units by the scale factors of the wire format. */
export function inSi(sample) {
  return {
    gyro: sample.gyro.map((count) => count * GYRO_RAD_PER_COUNT), accel: sample.accel.map((count) => count * ACCEL_MPS2_PER_COUNT),
    temperature: 25 + sample.temperature / 256,
  };
}

/** Largest difference of any axis from what the motion says, in counts of the wire format. */
export function worstCounts(sample, truth) {
  const si = inSi(sample);
  const off = (got, want, unit) => Math.max(...got.map((value, i) => Math.abs(value - want[i]) / unit));
  return Math.max(off(si.gyro, truth.gyro, GYRO_RAD_PER_COUNT), off(si.accel, truth.accel, ACCEL_MPS2_PER_COUNT),
    Math.abs(si.temperature - truth.temperature) * 256);
}
