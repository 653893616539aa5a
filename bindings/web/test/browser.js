// SPDX-License-Identifier: MIT
// A headless Chromium, spoken to over pipes: pages, what they say, and their pictures.
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

/** Why there is no browser here, or null. */
export const missing = spawnSync('chromium', ['--version']).status === 0 ? null
    : 'chromium is not here; third_party/install.sh --web installs it';

/** What `read` returns; nothing where the process has ended meanwhile. */
function quietly(read) {
    try {
        return read();
    } catch {
        return undefined;
    }
}

export class Browser {
    #process; #folder; #next = 1; #waiting = new Map(); #rest = '';

    constructor(...flags) {
        this.#folder = mkdtempSync(join(tmpdir(), 'crofton-page-'));
        this.#process = spawn('chromium', ['--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
            '--allow-file-access-from-files=false', '--hide-scrollbars', '--remote-debugging-pipe',
            `--user-data-dir=${this.#folder}`, ...flags, 'about:blank'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
        this.#process.stdio[4].on('data', (data) => this.#read(data));
        this.#process.on('exit', () => { for (const { failed } of this.#waiting.values()) failed(new Error('chromium ended')); });
    }
    #read(data) {
        const parts = (this.#rest + data).split('\0');
        this.#rest = parts.pop();
        for (const part of parts) {
            const { id, result, error } = JSON.parse(part);
            const waiting = this.#waiting.get(id);
            this.#waiting.delete(id);
            if (error) waiting?.failed(new Error(error.message));
            else waiting?.done(result);
        }
    }
    send(method, params = {}, sessionId) {
        const id = this.#next++;
        this.#process.stdio[3].write(JSON.stringify({ id, method, params, sessionId }) + '\0');
        return new Promise((done, failed) => this.#waiting.set(id, { done, failed }));
    }
    /** A page of that size at `url`, once `when` (JavaScript) is true in it; `first` runs before its scripts. */
    async open(url, { width = 960, height = 600, when = 'true', first } = {}) {
        const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
        const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
        const page = {
            evaluate: async (expression) => {
                const { result, exceptionDetails } = await this.send('Runtime.evaluate',
                    { expression, returnByValue: true, awaitPromise: true }, sessionId);
                if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
                return result.value;
            },
            picture: async () => Buffer.from((await this.send('Page.captureScreenshot', {}, sessionId)).data, 'base64'),
            close: () => this.send('Target.closeTarget', { targetId }),
        };
        await this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false }, sessionId);
        if (first) {
            await this.send('Page.enable', {}, sessionId);
            await this.send('Page.addScriptToEvaluateOnNewDocument', { source: first }, sessionId);
        }
        await this.send('Page.navigate', { url }, sessionId);
        for (const end = Date.now() + 60000; !await page.evaluate(when).catch(() => false);) {
            if (Date.now() > end) throw new Error(`${url}: waited a minute for ${when}`);
            await new Promise((next) => setTimeout(next, 50));
        }
        return page;
    }
    /** How long the browser's threads have run, and how long they were ready to run and others did, in ms. */
    processorTime() {
        const parents = new Map(), times = [0, 0];
        for (const id of readdirSync('/proc').filter((name) => Number(name) > 0))
            parents.set(id, quietly(() => readFileSync(`/proc/${id}/stat`, 'utf8').replace(/.*\) \S /, '').split(' ')[0]));
        const isOurs = (id) => id !== undefined && (id === String(this.#process.pid) || isOurs(parents.get(id)));
        for (const id of [...parents.keys()].filter(isOurs))
            for (const thread of quietly(() => readdirSync(`/proc/${id}/task`)) ?? []) {
                const counts = quietly(() => readFileSync(`/proc/${id}/task/${thread}/schedstat`, 'utf8')) ?? '0 0';
                counts.split(' ').slice(0, 2).forEach((nanoseconds, k) => { times[k] += nanoseconds / 1e6; });
            }
        return times;
    }
    async close() {
        const ended = new Promise((done) => this.#process.on('exit', done));
        this.#process.kill();
        await ended;
        rmSync(this.#folder, { recursive: true, force: true, maxRetries: 5, retryDelay: 200 });
    }
}
