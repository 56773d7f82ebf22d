// The worker of browsers.
import { serve } from './serve.js';

const take = serve((message, transferred) => self.postMessage(message, transferred));
self.onmessage = ({ data }) => take(data);
