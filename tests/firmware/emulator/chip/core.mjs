// What rp2040js' Cortex-M0+ gets wrong or leaves out, put right on the instance: sleep with interrupts masked, cycles of
// exceptions, alignment. Source: ARMv6-M Architecture Reference Manual, B1.5.

const EXCEPTION_CYCLES = 15; // Cortex-M0+ Technical Reference Manual: 15 cycles with zero wait states, either way

/** Wraps the core of `rp2040`; returns { takeExceptionCycles, wakeIfPending }. */
export function correctCore(rp2040, faults) {
  const { core } = rp2040;
  let exceptionCycles = 0;
  const entry = core.exceptionEntry.bind(core);
  core.exceptionEntry = (number) => {
    if (number === 3) faults.add('core', 'hard fault');
    exceptionCycles += EXCEPTION_CYCLES;
    entry(number);
  };
  const leave = core.exceptionReturn.bind(core);
  core.exceptionReturn = (value) => {
    exceptionCycles += EXCEPTION_CYCLES;
    leave(value);
  };
  // WFI ends when an enabled interrupt is pending, also with PRIMASK set; whether it is taken is decided afterwards.
  const wakeIfPending = () => {
    const pending = core.pendingInterrupts & core.enabledInterrupts;
    if (core.waiting && (pending || core.pendingSystick || core.pendingPendSV)) core.waiting = false;
  };
  core.setInterrupt = (irq, value) => {
    const bit = 1 << irq;
    if (!value) {
      core.pendingInterrupts &= ~bit;
    } else if (!(core.pendingInterrupts & bit)) {
      core.pendingInterrupts |= bit;
      core.interruptsUpdated = true;
      wakeIfPending();
    }
  };
  const takeExceptionCycles = () => {
    const taken = exceptionCycles;
    exceptionCycles = 0;
    return taken;
  };
  return { takeExceptionCycles, wakeIfPending };
}

/** A half word at an odd address is a hard fault on the chip; rp2040js reads it. */
export function checkAlignment(rp2040, faults) {
  for (const name of ['readUint16', 'writeUint16', 'writeUint32']) {
    const original = rp2040[name].bind(rp2040);
    const mask = name.endsWith('16') ? 1 : 3;
    rp2040[name] = (address, value) => {
      if (address & mask) faults.add('core', `${name} at unaligned 0x${(address >>> 0).toString(16)}`);
      return original(address, value);
    };
  }
}
