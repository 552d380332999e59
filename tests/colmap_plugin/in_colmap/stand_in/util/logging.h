// The glue includes COLMAP's header of this name and uses nothing of it.
#pragma once
