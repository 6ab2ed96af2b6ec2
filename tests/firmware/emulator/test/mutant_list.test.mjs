// The list of deliberate faults in tests/firmware/README.md is the one that is run.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';

import { mutants } from '../mutants/mutants.mjs';

const readme = readFileSync(new URL('../../README.md', import.meta.url), 'utf8');

test('the README lists every mutant with the test that catches it', () => {
  for (const { name, file, suite, test: catcher } of mutants) {
    assert.ok(readme.includes(`| ${name} | \`${file}\` | ${suite}: ${catcher} |`), name);
  }
  assert.ok(readme.includes(`All ${mutants.length} are caught`));
});

test('every mutant names a test that exists', () => {
  for (const { name, suite, test: catcher } of mutants) {
    const text = readFileSync(new URL(`${suite}.test.mjs`, import.meta.url), 'utf8');
    assert.ok(text.includes(`'${catcher}`), name);
  }
});
