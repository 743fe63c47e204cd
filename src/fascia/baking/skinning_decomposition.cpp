#include <fascia/baking/skinning_decomposition.h>
