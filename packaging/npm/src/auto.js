// hmesh/placeholder/auto: watches the page that loads it.
import { watch } from './placeholder.js';

watch();
