// mesh_image() and render() for coloured images, without and with alpha.
#include "channels.hpp"

HMESH_TOOLS_CHANNELS(3)
HMESH_TOOLS_CHANNELS(4)
