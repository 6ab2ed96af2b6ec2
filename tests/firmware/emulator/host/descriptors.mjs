// Descriptors of a device read and judged: USB 2.0 chapter 9, interface association ECN, CDC 1.2 with its ACM subclass.
// judge() names everything that a host could trip over; it does not know our firmware.

const TYPE = { device: 1, configuration: 2, interface: 4, endpoint: 5, association: 11, classSpecific: 0x24 };
const BULK_SIZES = [8, 16, 32, 64]; // full speed

export function parseDevice(bytes) {
  const word = (at) => bytes[at] | (bytes[at + 1] << 8);
  return {
    length: bytes[0], type: bytes[1], usb: word(2), class: [...bytes.slice(4, 7)], maxPacket0: bytes[7], vendor: word(8),
    product: word(10), release: word(12), strings: { manufacturer: bytes[14], product: bytes[15], serial: bytes[16] },
    configurations: bytes[17],
  };
}

/** The parts of a configuration in their order: { type, bytes }. Throws when the lengths do not chain. */
function split(bytes) {
  const parts = [];
  for (let at = 0; at < bytes.length; at += bytes[at]) {
    if (bytes[at] < 2 || at + bytes[at] > bytes.length) throw new Error(`descriptor at ${at} has length ${bytes[at]}`);
    parts.push({ type: bytes[at + 1], bytes: bytes.slice(at, at + bytes[at]) });
  }
  return parts;
}

export function parseConfiguration(bytes) {
  const parts = split(bytes);
  const [head] = parts;
  const configuration = {
    totalLength: head.bytes[2] | (head.bytes[3] << 8), count: head.bytes[4], value: head.bytes[5], attributes: head.bytes[7],
    milliamps: 2 * head.bytes[8], headLength: head.bytes.length, interfaces: [], associations: [], unknown: [],
  };
  for (const { type, bytes: part } of parts.slice(1)) addPart(configuration, type, part);
  return configuration;
}

function addPart(configuration, type, part) {
  const current = configuration.interfaces.at(-1);
  if (type === TYPE.association) {
    configuration.associations.push({ first: part[2], count: part[3], class: [...part.slice(4, 7)], length: part.length,
      afterInterfaces: configuration.interfaces.length });
  } else if (type === TYPE.interface) {
    configuration.interfaces.push({ number: part[2], alternate: part[3], endpointCount: part[4], class: [...part.slice(5, 8)],
      string: part[8], length: part.length, endpoints: [], functional: [] });
  } else if (type === TYPE.endpoint && current) {
    current.endpoints.push({ address: part[2], kind: part[3] & 3, attributes: part[3], maxPacket: part[4] | (part[5] << 8),
      interval: part[6], length: part.length });
  } else if (type === TYPE.classSpecific && current) {
    current.functional.push({ subtype: part[2], bytes: part });
  } else {
    configuration.unknown.push(type);
  }
}

function judgeDevice(device, problem) {
  if (device.length !== 18 || device.type !== TYPE.device) problem('device descriptor: length or type');
  if (device.usb !== 0x0200) problem(`device: bcdUSB ${device.usb.toString(16)}`);
  if (![8, 16, 32, 64].includes(device.maxPacket0)) problem(`device: bMaxPacketSize0 ${device.maxPacket0}`);
  if (device.configurations !== 1) problem(`device: ${device.configurations} configurations`);
  if (String(device.class) !== '239,2,1') problem(`device: class ${device.class} does not announce associations`);
}

function judgeHead(configuration, bytes, problem) {
  if (configuration.headLength !== 9) problem('configuration: length of its head');
  if (configuration.totalLength !== bytes.length) problem(`configuration: wTotalLength ${configuration.totalLength} of ${bytes.length}`);
  if (configuration.count !== configuration.interfaces.length) problem(`configuration: bNumInterfaces ${configuration.count}`);
  if (configuration.value === 0) problem('configuration: value 0');
  if (!(configuration.attributes & 0x80) || configuration.attributes & 0x1f) problem('configuration: reserved attributes');
  if (configuration.milliamps === 0 || configuration.milliamps > 500) problem(`configuration: ${configuration.milliamps} mA`);
  if (configuration.unknown.length) problem(`configuration: descriptors of type ${configuration.unknown}`);
}

function judgeEndpoint(endpoint, seen, problem) {
  const name = `endpoint 0x${endpoint.address.toString(16)}`;
  if (endpoint.length !== 7) problem(`${name}: length`);
  if (endpoint.address & 0x70 || (endpoint.address & 15) === 0) problem(`${name}: address`);
  if (seen.has(endpoint.address)) problem(`${name}: twice`);
  seen.add(endpoint.address);
  if (endpoint.kind === 2 && !BULK_SIZES.includes(endpoint.maxPacket)) problem(`${name}: bulk packets of ${endpoint.maxPacket}`);
  if (endpoint.kind === 3 && (endpoint.maxPacket > 64 || endpoint.maxPacket === 0)) problem(`${name}: packets of ${endpoint.maxPacket}`);
  if (endpoint.kind === 3 && endpoint.interval === 0) problem(`${name}: interval 0`);
  if (endpoint.kind < 2 || endpoint.attributes & ~3) problem(`${name}: attributes`);
}

function judgeInterfaces(configuration, problem) {
  const seen = new Set();
  configuration.interfaces.forEach((one, i) => {
    if (one.length !== 9) problem(`interface ${i}: length`);
    if (one.number !== i || one.alternate !== 0) problem(`interface ${i}: numbered ${one.number}.${one.alternate}`);
    if (one.endpointCount !== one.endpoints.length) problem(`interface ${i}: bNumEndpoints ${one.endpointCount}`);
    for (const endpoint of one.endpoints) judgeEndpoint(endpoint, seen, problem);
  });
}

function judgeAssociations(configuration, problem) {
  for (const { first, count, class: kind, length, afterInterfaces } of configuration.associations) {
    if (length !== 8 || first !== afterInterfaces) problem(`association of ${first}: length or place`);
    if (first + count > configuration.interfaces.length) problem(`association of ${first}: ${count} interfaces`);
    if (String(configuration.interfaces[first]?.class.slice(0, 2)) !== String(kind.slice(0, 2))) problem(`association of ${first}: class`);
  }
  const control = configuration.interfaces.find((one) => one.class[0] === 2);
  if (control && !configuration.associations.some(({ first }) => first === control.number)) problem('serial port without association');
}

/** CDC 1.2, 5.2.3: header, call management, ACM, union; notification endpoint; data interface with one pipe each way. */
function judgeSerialPort(configuration, problem) {
  const control = configuration.interfaces.find((one) => one.class[0] === 2);
  if (!control) return problem('no communications interface');
  const part = (subtype) => control.functional.find((one) => one.subtype === subtype)?.bytes;
  if (control.class[1] !== 2) problem('communications interface is no abstract control model');
  if (control.functional[0]?.subtype !== 0) problem('header functional descriptor is not the first');
  if (part(0)?.length !== 5) problem('header functional descriptor');
  if (part(2)?.length !== 4 || !(part(2)[3] & 2)) problem('ACM functional descriptor: line coding is not announced');
  const union = part(6);
  const data = union && configuration.interfaces[union[4]];
  if (union?.length !== 5 || union[3] !== control.number || data?.class[0] !== 10) return problem('union functional descriptor');
  if (part(1)?.length !== 5 || part(1)[4] !== data.number) problem('call management functional descriptor');
  if (control.endpoints.length !== 1 || control.endpoints[0].kind !== 3 || !(control.endpoints[0].address & 0x80)) {
    problem('notification endpoint');
  }
  const directions = data.endpoints.filter((endpoint) => endpoint.kind === 2).map((endpoint) => endpoint.address >> 7).sort();
  if (String(directions) !== '0,1') problem('data interface: pipes');
  return undefined;
}

/** Everything wrong with a device's descriptors; an empty list when a host can be content. */
export function judge(deviceBytes, configurationBytes) {
  const problems = [];
  const problem = (text) => void problems.push(text);
  judgeDevice(parseDevice(deviceBytes), problem);
  const configuration = parseConfiguration(configurationBytes);
  judgeHead(configuration, configurationBytes, problem);
  judgeInterfaces(configuration, problem);
  judgeAssociations(configuration, problem);
  judgeSerialPort(configuration, problem);
  return problems;
}

/** The text of a string descriptor; throws when it is none. */
export function stringOf(bytes) {
  if (bytes[0] !== bytes.length || bytes[1] !== 3 || bytes.length % 2) throw new Error('malformed string descriptor');
  return new TextDecoder('utf-16le').decode(bytes.slice(2));
}
