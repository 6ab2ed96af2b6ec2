// What an operating system does with a newly plugged device: reset, address, descriptors, configuration. Every answer is
// checked; the result is what was read.
import { MILLISECOND } from '../board/board.mjs';
import { judge, parseConfiguration, parseDevice, stringOf } from './descriptors.mjs';
import { request } from './usb_host.mjs';

const GET = 0x80;
const descriptor = (kind, index, length, language = 0) => request(GET, 6, (kind << 8) | index, language, length);

/** Reset, address, descriptors, configuration 1. Returns { device, configuration, strings }. */
export function enumerate(board, host, { address = 7, busyBus = false } = {}) {
  if (!host.waitForAttach(500 * MILLISECOND)) throw new Error('the device does not show itself within 500 ms');
  board.run(100 * MILLISECOND); // debounce
  host.reset({ busyBus });
  const first = host.controlIn(descriptor(1, 0, 64));
  if (first.length !== 18) throw new Error(`device descriptor of ${first.length} bytes`);
  host.reset({ busyBus });
  setAddress(board, host, address);
  const read = readDescriptors(host);
  host.controlOut(request(0, 9, read.configuration.value));
  if (host.controlIn(request(GET, 8, 0, 0, 1))[0] !== read.configuration.value) throw new Error('GET_CONFIGURATION');
  return read;
}

/** SET_ADDRESS; afterwards the old address must be dead. */
export function setAddress(board, host, address) {
  host.controlOut(request(0, 5, address));
  board.run(2 * MILLISECOND);
  if (host.port.setup(host.address, new Uint8Array(8)) !== 'timeout') throw new Error('answers at its old address');
  host.address = address;
}

function readDescriptors(host) {
  const deviceBytes = host.controlIn(descriptor(1, 0, 18));
  const device = parseDevice(deviceBytes);
  host.maxPacket0 = device.maxPacket0;
  const head = host.controlIn(descriptor(2, 0, 9));
  const total = head[2] | (head[3] << 8);
  const configurationBytes = host.controlIn(descriptor(2, 0, total));
  const problems = judge(deviceBytes, configurationBytes);
  if (problems.length) throw new Error(`descriptors: ${problems.join('; ')}`);
  if (host.controlIn(descriptor(2, 0, 255)).length !== total) throw new Error('configuration differs with another length');
  const configuration = parseConfiguration(configurationBytes);
  return { device, configuration, strings: readStrings(host, device, configuration) };
}

function readStrings(host, device, configuration) {
  const languages = host.controlIn(descriptor(3, 0, 255));
  if (languages.length < 4) throw new Error('no language');
  const language = languages[2] | (languages[3] << 8);
  const text = (index) => stringOf(host.controlIn(descriptor(3, index, 255, language)));
  const named = Object.entries(device.strings).map(([name, index]) => [name, index ? text(index) : null]);
  const interfaces = configuration.interfaces.map((one) => (one.string ? text(one.string) : null));
  return { ...Object.fromEntries(named), interfaces };
}
