// SPDX-License-Identifier: GPL-3.0-or-later
// The package for the web as a stranger has it: the tarball of `npm pack`, installed beside three in an empty folder. Skipped, aloud,
// without Chromium or npm's registry (MESHLODE_REQUIRE_BROWSER=1, MESHLODE_REQUIRE_NPM=1: a failure).
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { browserPath } from '../viewer/chromium.mjs';

const THREE = '0.187.0';

function skip(why, variable) {
  const isAsked = process.env[variable] === '1';
  console.log(`${isAsked ? 'FAILED' : 'SKIPPED'}: ${why}`);
  process.exit(isAsked ? 1 : 77);
}

/** {work, npm, bytes}: a new folder with node_modules, npm run in it, and the bytes of the tarball. */
export function installPackage(npmFolder) {
  if (!browserPath) skip('no Chromium (Debian: chromium)', 'MESHLODE_REQUIRE_BROWSER');
  if (spawnSync('npm', ['--version']).status !== 0) skip('no npm (Debian: npm)', 'MESHLODE_REQUIRE_NPM');
  const work = mkdtempSync(join(tmpdir(), 'meshlode-three-'));
  const npm = (...args) => execFileSync('npm', args, { cwd: work, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'],
    env: { ...process.env, npm_config_update_notifier: 'false', npm_config_audit: 'false', npm_config_fund: 'false',
      npm_config_fetch_retries: '1', npm_config_fetch_retry_mintimeout: '1000' } });
  const tarball = npm('pack', npmFolder, '--silent').trim().split('\n').pop();
  writeFileSync(join(work, 'package.json'), '{"private": true, "type": "module"}');
  try {
    npm('install', '--ignore-scripts', `three@${THREE}`, `./${tarball}`);
  } catch (error) {
    console.log(error.stderr?.slice(-400) ?? error.message);
    rmSync(work, { recursive: true });
    skip('npm cannot install three', 'MESHLODE_REQUIRE_NPM');
  }
  return { work, npm, bytes: statSync(join(work, tarball)).size };
}
