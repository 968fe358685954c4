/* Preprocessed by build.rs, never compiled: which Embree do the compiler's own folders hold? */
#if __has_include(<embree4/rtcore_config.h>)
#include <embree4/rtcore_config.h>
int found_embree = 4;
#elif __has_include(<embree3/rtcore_config.h>)
#include <embree3/rtcore_config.h>
int found_embree = 3;
#endif
