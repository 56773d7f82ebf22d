// A worker's side of Mesher: takes messages, answers with what hmesh makes of them.
import { Hmesh, help } from './engine.js';

// post(message, transferred): answers.
export function serve(post) {
  let hmesh, image;
  const buffers = (mesh) => [mesh.positions.buffer, mesh.colors.buffer, mesh.indices.buffer];
  const answer = (message) => {
    if ('write' in message) {
      const result = hmesh.write(message.mesh, message.write, message.options);
      return post({ result }, [result.buffer]);
    }
    if ('render' in message) {
      const result = hmesh.render(message.mesh, message.options);
      return post({ result }, [result.data.buffer]);
    }
    if ('read' in message) {
      const result = hmesh.read(message.read, message.options);
      return post({ result }, buffers(result));
    }
    const { options, refine, flag } = message, { effort } = options;
    image = message.image ?? image;
    let told = -1;
    const show = (mesh) => post({ mesh: { ...mesh, effort } }, buffers(mesh));
    const onProgress = (progress) => {
      if (progress.total >= told + 0.005 || progress.total === 1) {
        told = progress.total;
        post({ progress: { ...progress, effort } });
      }
      return !flag || Atomics.load(flag, 0) === 0;
    };
    show(hmesh.meshImage(image, { ...options, onProgress, onMesh: refine ? show : undefined }));
  };
  return (message) => {
    const { module, memory, stack, helpers, maximumMemory } = message;
    if (stack) return help(module, memory, stack);
    try {
      if (module) {
        hmesh = new Hmesh(module, { maximumMemory, memory });
        return memory && post({ stacks: hmesh.stacks(helpers) });
      }
      answer(message);
      return post({ done: true });
    } catch (error) {
      return post({ done: true, error: { message: error.message, code: error.code } });
    }
  };
}
