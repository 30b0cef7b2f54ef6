#!/usr/bin/env bash
# A compiler's launcher, objects_of.sh COMPILER ...: instead of compiling SOURCE for -o OBJECT, takes the object of that name in
# ISOWAVE_OBJECTS where it is newer than its source in ISOWAVE_OBJECTS_SOURCE, as ninja has left it.
set -euo pipefail
object= source= previous=
for word; do
    [[ $previous != -o ]] || object=$word
    [[ $previous != -c ]] || source=$word
    previous=$word
done
made=$ISOWAVE_OBJECTS/$object
original=$ISOWAVE_OBJECTS_SOURCE/${source#*/checkout/}
if [[ -n $object && -e $made && $made -nt $original ]]; then
    cp "$made" "$object"
    exit
fi
exec "$@"
