// True time of a test in nanoseconds and what is due in it. It knows no chip; every model schedules here.

/** Events in order of time; equal times in order of scheduling. */
export class World {
  now = 0;
  #events = [];

  /** Calls `action` at absolute time `at` (not before now). Returns a handle for cancel(). */
  schedule(at, action) {
    const event = { at: Math.max(at, this.now), action };
    let low = 0;
    let high = this.#events.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.#events[middle].at <= event.at) low = middle + 1;
      else high = middle;
    }
    this.#events.splice(low, 0, event);
    return event;
  }

  after(delayNanos, action) {
    return this.schedule(this.now + delayNanos, action);
  }

  cancel(event) {
    const at = event ? this.#events.indexOf(event) : -1;
    if (at >= 0) this.#events.splice(at, 1);
  }

  get nextAt() {
    return this.#events.length ? this.#events[0].at : Infinity;
  }

  /** Moves time to `target` and calls everything that is due on the way. */
  advanceTo(target) {
    if (target < this.nextAt) {
      if (target > this.now) this.now = target;
      return;
    }
    while (this.#events.length && this.#events[0].at <= target) {
      const event = this.#events.shift();
      this.now = Math.max(this.now, event.at);
      event.action();
    }
    this.now = Math.max(this.now, target);
  }
}

/** The clock that rp2040js wants, counted from a start of the chip. After stop() its alarms are dead. */
export class ChipClock {
  #world;
  #startedAt;
  #stopped = false;

  constructor(world) {
    this.#world = world;
    this.#startedAt = world.now;
  }

  get nanos() {
    return this.#world.now - this.#startedAt;
  }

  get micros() {
    return this.nanos / 1000;
  }

  stop() {
    this.#stopped = true;
  }

  createAlarm(callback) {
    let event = null;
    const cancel = () => {
      this.#world.cancel(event);
      event = null;
    };
    const schedule = (deltaNanos) => {
      cancel();
      event = this.#world.after(deltaNanos, () => {
        event = null;
        if (!this.#stopped) callback();
      });
    };
    return { schedule, cancel };
  }
}
