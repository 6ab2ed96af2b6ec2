// The emulated board with its serial port on standard output: a pseudo terminal that somebody else made. The sensor moves as a
// file of slam-sim says, which knows the future: the board runs ahead as fast as it can, and its bytes leave when they are due
// (CLOCK_MONOTONIC), so that a busy machine does not show in them. Ends at the end of the motion.
//   SLAMD_FIRMWARE=slamd-imu.uf2 node bridge.mjs MOTION.csv [--linger SECONDS]
import { writeSync } from 'node:fs';

import { Board } from '../board/board.mjs';
import { RecordedMotion } from '../board/recorded_motion.mjs';
import { SerialPort } from '../host/serial_port.mjs';

const AHEAD_NANOS = 5e6; // emulated between two looks at the clock
const now = () => process.hrtime.bigint();
const sleeper = new Int32Array(new SharedArrayBuffer(4));
const sleep = (milliseconds) => Atomics.wait(sleeper, 0, 0, milliseconds);

/** Bytes on their way to the terminal, each packet with the moment it is due. What a full terminal does not take is lost. */
class Outgoing {
  lost = 0;
  latestNs = 0; // of those due since the motion began
  #packets = [];
  #next = 0;
  #startNs;

  constructor(startNs) {
    this.#startNs = startNs;
  }

  push(bytes, dueNs) {
    this.#packets.push({ bytes, dueNs });
  }

  /** Sends what is due. */
  send() {
    for (; this.#next < this.#packets.length && this.#packets[this.#next].dueNs <= now(); this.#next += 1) {
      const { bytes, dueNs } = this.#packets[this.#next];
      if (dueNs >= this.#startNs) this.latestNs = Math.max(this.latestNs, Number(now() - dueNs));
      this.lost += bytes.length - this.#write(bytes);
    }
  }

  #write(bytes) {
    try {
      return writeSync(1, bytes);
    } catch (error) {
      if (error.code !== 'EAGAIN') throw error;
      return 0;
    }
  }
}

function run(motionPath, lingerSeconds) {
  const motion = new RecordedMotion(motionPath);
  const board = new Board();
  const outgoing = new Outgoing(motion.startNs);
  board.sensor.keepSamples = false;
  let origin = now();
  const hostTime = (nanos) => origin + BigInt(Math.round(nanos));
  board.sensor.motion = (seconds) => motion.at(hostTime(seconds * 1e9));
  board.powerOn();
  const port = new SerialPort(board).plugIn({ open: false });
  port.reader = { push: (bytes, at) => outgoing.push(bytes, hostTime(at)) };
  origin = now() - BigInt(Math.round(board.world.now)); // from here on the board's time is the host's
  port.open();
  const end = motion.endNs + BigInt(lingerSeconds) * 1000000000n;
  while (now() < end) {
    outgoing.send();
    if (hostTime(board.world.now) < end) board.run(AHEAD_NANOS);
    else sleep(1);
  }
  board.faults.assertNone();
  console.error(`bridge: ${(board.world.now / 1e9).toFixed(1)} s, ${port.pipe.packets} packets, ${outgoing.lost} bytes that nobody read, `
    + `the latest ${(outgoing.latestNs / 1e6).toFixed(1)} ms late`);
}

const linger = process.argv.indexOf('--linger');
run(process.argv[2], linger > 0 ? Number(process.argv[linger + 1]) : 0);
