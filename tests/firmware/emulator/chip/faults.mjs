// What must not happen, collected: a test ends by asserting that nothing did. Also the logger that rp2040js writes to.

/** Keeps messages with the time; a rule that is broken ten thousand times is kept once with its count. */
export class Faults {
  #world;
  #counts = new Map();

  constructor(world) {
    this.#world = world;
  }

  add(where, what) {
    const key = `[${where}] ${what}`;
    const known = this.#counts.get(key);
    if (known) known.count += 1;
    else this.#counts.set(key, { firstAtMs: this.#world.now / 1e6, count: 1 });
  }

  get list() {
    return [...this.#counts].map(([key, { firstAtMs, count }]) => `${firstAtMs.toFixed(3)} ms ${key} (${count} times)`);
  }

  /** Throws when anything was reported. */
  assertNone() {
    if (this.#counts.size) throw new Error(`rules broken on the emulated board:\n  ${this.list.join('\n  ')}`);
  }

  /** Takes away what matches (a fault that the test provoked on purpose); returns how many there were. */
  take(pattern) {
    let taken = 0;
    for (const [key, { count }] of this.#counts) {
      if (!pattern.test(key)) continue;
      taken += count;
      this.#counts.delete(key);
    }
    return taken;
  }

  /** A logger for rp2040js: its warnings and errors are faults. */
  logger() {
    return {
      debug: () => {},
      info: () => {},
      warn: (where, what) => this.add(where, what),
      error: (where, what) => this.add(where, what),
    };
  }
}
