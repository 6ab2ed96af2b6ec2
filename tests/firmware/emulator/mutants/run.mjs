// Builds every mutant of mutants.mjs from the commands of an existing build of target `firmware` and runs the test that has to
// catch it. Exit code 1 when one survives, or is not what it should be (text not found once, does not compile).
//   node mutants/run.mjs BUILD-FOLDER [WORD of the name]
import { spawn, execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

import { mutants } from './mutants.mjs';

const package_ = resolve(dirname(fileURLToPath(import.meta.url)), '..');
const source = resolve(package_, '../../..');
const TEST_LIMIT_MS = 240e3;
const WORKERS = 2;

const [build, word = ''] = [resolve(process.argv[2]), process.argv[3]];
const built = join(build, 'firmware');
const work = join(build, 'firmware-mutants');

function run(command, args, options = {}) {
  return new Promise((done) => {
    const child = spawn(command, args, { ...options, stdio: ['ignore', 'pipe', 'pipe'] });
    const timer = setTimeout(() => child.kill('SIGKILL'), TEST_LIMIT_MS);
    let output = '';
    child.stdout.on('data', (text) => (output += text));
    child.stderr.on('data', (text) => (output += text));
    child.on('close', (code) => {
      clearTimeout(timer);
      done({ code, output });
    });
  });
}

/** What ninja would run for the target: compilations, link, image. */
function buildCommands() {
  const lines = execFileSync('ninja', ['-C', build, '-t', 'commands', 'firmware'], { encoding: 'utf8' }).trim().split('\n');
  return lines.filter((line) => line.includes(`cd ${built} `));
}

const escaped = (text) => text.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');

/** A copy of the sources with the fault in it; returns its folder. */
function plant(mutant, folder) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(join(folder, 'out'), { recursive: true });
  cpSync(join(source, 'firmware'), join(folder, 'firmware'), { recursive: true });
  cpSync(built, join(folder, 'out'), { recursive: true });
  const path = join(folder, 'firmware', mutant.file);
  const text = readFileSync(path, 'utf8');
  const found = new RegExp(escaped(mutant.find).replace(/\s+/g, '\\s+'), 'g'); // however the sources are formatted
  const times = text.match(found)?.length ?? 0;
  if (times !== 1) throw new Error(`the text stands ${times} times in ${mutant.file}`);
  writeFileSync(path, text.replace(found, () => mutant.replace));
}

async function make(mutant, folder, commands) {
  const inHeader = mutant.file.endsWith('.hpp');
  for (const command of commands) {
    const compiles = command.includes(' -c ');
    if (compiles && !inHeader && !command.includes(`${source}/firmware/${mutant.file} `)) continue;
    const moved = command.replaceAll(built, '@out@').replaceAll(source, folder).replaceAll('@out@', join(folder, 'out'));
    const { code, output } = await run('sh', ['-c', moved.replace(' -Werror', '')]);
    if (code !== 0) throw new Error(`does not build:\n${output}`);
  }
}

/** Whether the named test fails on the image, and it alone was run. */
async function caught(mutant, image) {
  const name = escaped(mutant.test);
  const { output } = await run(process.execPath, ['--test', '--test-reporter=tap', `--test-name-pattern=^${name}`,
    `test/${mutant.suite}.test.mjs`], { cwd: package_, env: { ...process.env, SLAMD_FIRMWARE: image } });
  return new RegExp(`^ *not ok \\d+ - ${name}`, 'm').test(output);
}

async function judge(mutant, index, commands) {
  const folder = join(work, String(index));
  try {
    plant(mutant, folder);
    await make(mutant, folder, commands);
    return (await caught(mutant, join(folder, 'out', 'slamd-imu.uf2'))) ? 'caught' : 'SURVIVED';
  } catch (error) {
    return `BROKEN: ${error.message}`;
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

const commands = buildCommands();
const chosen = mutants.filter(({ name }) => name.includes(word));
const results = [];
let next = 0;
async function worker() {
  while (next < chosen.length) {
    const index = next++;
    const mutant = chosen[index];
    results[index] = await judge(mutant, index, commands);
    console.log(`${results[index].padEnd(8)} ${mutant.name} (${mutant.suite}: ${mutant.test})`);
  }
}
await Promise.all(Array.from({ length: WORKERS }, worker));
const failed = results.filter((result) => result !== 'caught').length;
console.log(`# pass ${results.length - failed}\n# fail ${failed}`); // as node's test runner ends, for who counts cases
process.exitCode = failed ? 1 : 0;
