// Times on the wire at full speed. Nothing else.

const BIT_NANOS = 1e9 / 12e6;
const PACKET_BITS = 42; // sync, PID, address or CRC, end of packet, turn-around

/** Time of a transaction with `bytes` of data: token, data packet, handshake. */
export function packetNanos(bytes) {
  return (3 * PACKET_BITS + 8 * bytes) * BIT_NANOS;
}
