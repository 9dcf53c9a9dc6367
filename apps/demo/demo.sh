#!/bin/sh
# The whole system at work: record a route three times, build a map, drive again in another season,
# watch the daemon choose, and drive at night on a map without one. `./dev demo` runs this from the
# source root after the build.
set -eu

demo=build/demo
warmup=40
frames=150
rate=15 # pictures per second, sent as a camera would
url=udpm://239.255.76.67:7671?ttl=0
join='ip link set lo up && ip route add 224.0.0.0/4 dev lo'
pids=

say()
{
    printf '\n== %s\n\n' "$*"
}

die()
{
    echo "demo: $*" >&2
    exit 1
}

vdna()
{
    build/bin/vdna "$@"
}

# Leave no daemon behind, whatever happens.
clean_up()
{
    for pid in $pids; do
        kill "$pid" 2>/dev/null || :
    done
}
trap clean_up EXIT
trap 'exit 130' INT TERM

# LCM needs multicast, which works in our own network namespace without privileges. If the system
# refuses a namespace, use its network; ttl=0 keeps every message on this machine.
find_network()
{
    [ -z "${VDNA_DEMO_NETWORK:-}" ] || return 0
    export VDNA_DEMO_NETWORK=own
    if unshare -rn sh -c "$join" 2>/dev/null; then
        exec unshare -rn sh -c "$join"' && exec "$0" "$@"' "$0" "$@"
    fi
    ip route get 239.255.76.67 >/dev/null 2>&1 || die "this machine has no route for multicast," \
        "which LCM needs; as root, run: $join"
}

# record NAME CONDITION ARG...
record()
{
    name=$1
    condition=$2
    shift 2
    echo "$demo/$name"
    vdna simulate "$demo/$name" --condition "$condition" --frames "$frames" --step 1 "$@"
}

start_daemon()
{
    build/bin/vdna_selectord --map $demo/map --warmup-frames $warmup -l "$url" \
        >$demo/selectord.out 2>$demo/selectord.log &
    daemon=$!
    pids="$pids $daemon"
    tries=150
    until grep -q '^vdna_selectord: READY' $demo/selectord.out; do
        tries=$((tries - 1))
        if ! kill -0 $daemon 2>/dev/null || [ $tries -eq 0 ]; then
            cat $demo/selectord.log >&2
            die "the daemon did not become ready; see its output above"
        fi
        sleep 0.2
    done
    cat $demo/selectord.out
}

stop_daemon()
{
    kill -TERM $daemon
    status=0
    wait $daemon || status=$?
    pids=
    [ $status -eq 0 ] || die "the daemon ended with exit code $status; see $demo/selectord.log"
}

drive()
{
    vdna watch -l "$url" --summary --for $((frames / rate + 4)) &
    watch=$!
    pids="$pids $watch"
    sleep 1 # let the watcher start listening first
    vdna play $demo/live --rate $rate -l "$url"
    wait $watch
}

[ -x build/bin/vdna ] && [ -x build/bin/vdna_selectord ] || die "run ./dev demo, which builds first"
find_network "$@"
rm -rf $demo
mkdir -p $demo

say "1. One route, driven in summer, in winter and at night (rendered)"
for condition in summer winter night; do
    record $condition $condition
done

say "2. A map of the route: one Visual DNA per traversal"
vdna build $demo/map $demo/summer $demo/winter $demo/night

say "3. The same route on a spring day, which the map has never seen"
record live spring --start 2 --variation 0.7 --drive 12

say "4. The daemon receives the camera, warms up for $warmup frames, and chooses"
start_daemon
drive
stop_daemon

say "5. Was it right? Every candidate, against the true positions"
vdna localise $demo/live $demo/map --skip $warmup --tolerance 2.5 --matrix $demo/matrices.png

say "6. Why that one? The neurons that tell it from the next, and the frames with most and least of them"
vdna explain $demo/live $demo/map --warmup $warmup
vdna show $demo/map summer $warmup -o $demo/frame.png

say "7. Where is it? On the winter map, as the paper does: each frame by itself, by the network's last layer"
vdna build $demo/paper $demo/winter --backbone efficientnet_lite0_paper
vdna localise $demo/live $demo/paper --skip $warmup --tolerance 2.5 --localiser nearest \
    --matrix $demo/winter_paper.png

say "8. The same drive on the same map, by the place filter"
vdna localise $demo/live $demo/map --in winter --skip $warmup --tolerance 2.5 \
    --matrix $demo/winter_filter.png

say "9. And at night, with a map of three days?"
for condition in summer autumn overcast; do
    record day_$condition $condition --variation 0.6 --drive 20
done
record tonight night --drive 30
vdna build $demo/days $demo/day_summer $demo/day_autumn $demo/day_overcast
status=0
vdna rank $demo/tonight $demo/days --warmup $warmup || status=$?
[ $status -eq 3 ] || die "night on a map of days: expected exit code 3, none fits, found $status"
echo "exit code 3: none fits"

say "Done"
cat <<END
The ranking came from appearance alone. It is right if its first choice has the best Recall@1 in step 5,
or where that is equal, the fewest unsure answers. The dots of step 7 are all over the matrix, those of
step 8 are a line. Step 9 is answered as it should be: with none of them, rather than with the least bad.
Pictures: $demo/{summer,winter,night,live}   map: $demo/map   difference matrices: $demo/matrices.png
and $demo/winter_{paper,filter}.png

To use your own pictures or videos, one folder or file per traversal:
    build/bin/vdna build MAP TRAVERSAL...
    build/bin/vdna rank LIVE MAP --warmup 100
    build/bin/vdna_selectord --map MAP --warmup-frames 100
END
