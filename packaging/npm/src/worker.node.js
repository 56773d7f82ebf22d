// The worker of node and deno.
import { parentPort } from 'node:worker_threads';
import { serve } from './serve.js';

parentPort.on('message', serve((message, transferred) => parentPort.postMessage(message, transferred)));
