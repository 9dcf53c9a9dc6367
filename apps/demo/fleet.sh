#!/bin/sh
# A fleet at work: 200 traversals of five routes become a collection, which two workers build and search.
# `./dev demo --fleet` runs this from the source root after the build. $1: local or ray, the engine.
set -eu

engine=${1:-local}
demo=build/demo/fleet
python=build/wheel # with the wheel
conditions="spring summer autumn winter overcast rain dusk night"
pictures="--frames 24 --step 1 --size 96x72 --variation 0.6"

say()
{
    printf '\n== %s\n\n' "$*"
}

fleet()
{
    command=$1
    shift
    "$python/bin/vdna-fleet" "$command" "$demo/collection" "$@" --engine "$engine" --workers 2
}

# Each line: the name of a drive, and the arguments that render it.
drives()
{
    for route in 1 2 3 4 5; do
        for day in 1 2 3 4 5; do
            for condition in $conditions; do
                [ $day -lt 5 ] || [ "$condition" != night ] || continue # its place is a duplicate's
                echo "$demo/drives/route${route}_${condition}_$day --condition $condition" \
                    "--seed 20$route --drive $((100 * route + 10 * day + ${#condition}))"
            done
        done
    done
}

# today ROUTE: renders a drive that the collection has never seen
today()
{
    # shellcheck disable=SC2086 # a list of words
    build/bin/vdna simulate "$demo/today$1" --condition dusk --seed "20$1" --drive "9$1" $pictures
}

# recall LIVE MAP: percent, in the experience where it is best
recall()
{
    build/bin/vdna localise "$1" "$2" --skip 8 --tolerance 2 --localiser nearest --json |
        /usr/bin/python3 -c 'import json, sys
print(max(one["recall_percent"] for one in json.load(sys.stdin)["candidates"]))'
}

# whole ROUTE MAP: writes all experiences of a route as a map
whole()
{
    "$python/bin/python3" - "$demo/collection" "$@" <<'END'
import pathlib, sys
from libvdna import fleet
uri, route, folder = sys.argv[1:]
collection = fleet.Collection(uri)
index = fleet.Index(collection, collection.only_comparable(), [("route", "==", route)])
pathlib.Path(folder).mkdir()
for row, name in enumerate(index.names):
    index.load(row).experience.write(pathlib.Path(folder) / f"{name}.vdna")
END
}

[ -x build/bin/vdna ] || {
    echo "demo: run ./dev demo --fleet, which builds first" >&2
    exit 1
}
rm -rf $demo
mkdir -p $demo/drives
start=$(date +%s)

say "1. 200 traversals of five routes (rendered), five of them copies of others"
drives | xargs -P 2 -L 1 build/bin/vdna simulate $pictures >$demo/simulate.log
echo source,route,condition >$demo/table.csv
for route in 1 2 3 4 5; do
    cp -r $demo/drives/route${route}_dusk_2 $demo/drives/route${route}_dusk_2copy
done
for drive in "$demo"/drives/*; do
    name=${drive##*/}
    rest=${name#*_}
    echo "$drive,${name%%_*},${rest%_*}" >>$demo/table.csv
done
echo "$(($(wc -l <$demo/table.csv) - 1)) traversals in $demo/drives, listed in $demo/table.csv"

say "2. Ranges of ten of them, merged; all of them as experiences; an index: two workers"
fleet calibrate --vdna build/bin/vdna $demo/drives/route?_summer_1 $demo/drives/route?_night_1
fleet build --vdna build/bin/vdna --table $demo/table.csv
fleet index
du -sh $demo/collection/*

say "3. A drive of today on route 3, which the collection has never seen: its nearest, exactly"
today 3
build/bin/vdna build $demo/now $demo/today3 --ranges $demo/collection/ranges.json
fleet nearest $demo/now/today3.vdna -k 5
fleet nearest $demo/now/today3.vdna -k 3 --where route=route3 --where condition!=dusk

say "4. Traversals that repeat another one are dropped"
fleet duplicates --within 0 --drop

say "5. A robot has room for 100 MB: the subset that loses least expected recall"
fleet ship $demo/map --budget 100000000 --tolerance 2
ls $demo/map

say "6. What the robot's recall loses by it: a drive of today on each route"
for route in 1 2 3 4 5; do
    [ $route = 3 ] || today $route
    whole route$route $demo/whole
    echo "route$route $(recall $demo/today$route $demo/map) $(recall $demo/today$route $demo/whole)"
    rm -r $demo/whole
done >$demo/recall.txt
awk '{ print $1 ": recall " $2 " % with what was shipped, " $3 " % with all"; lost += $3 - $2 }
    END { print "lost: " lost / NR " points on average" }' $demo/recall.txt

say "Done in $(($(date +%s) - start)) s"
cat <<END
The five copies were found and dropped, whatever their names. Steps 3 and 4 computed few of all distances:
bounds in the index ruled out the others. Step 2 may be interrupted and given again: it goes on where it was.
The same on Ray: $python/bin/pip install ray, then ./dev demo --fleet ray
END
