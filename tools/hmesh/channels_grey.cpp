// mesh_image() and render() for grey images, without and with alpha.
#include "channels.hpp"

HMESH_TOOLS_CHANNELS(1)
HMESH_TOOLS_CHANNELS(2)
