# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Images, odometry and transforms as they come, in; estimates, out. Without ROS, and without a clock of its own."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Mapping, Sequence

from posemix._core import MotionModel, RelocaliseOutcome, StampAdmission, SymmetryGroup, relocalise
from posemix.ros.configuration import Configuration
from posemix.ros.estimates import EngineCounts, LiveEstimate
from posemix.ros.known_classes import KnownClasses
from posemix.ros.live_run import LiveRun
from posemix.ros.map_files import MapFiles
from posemix.ros.maps import SavedMap, carried_over, merged, read_map, with_priors, write_map
from posemix.ros.messages import Image
from posemix.ros.surroundings import ReadyImage, Surroundings
from posemix.ros.transforms import LiveTransforms

__all__ = ["Engine"]

# Images in succession whose stamps have jumped, after which the clock is taken to have jumped: not one wrong stamp.
_JUMPED = 5
# Time between two attempts to find an old map in the world of the run [s].
_ATTEMPTS_S = 0.5

class Engine:
    """Object SLAM by stamps over what a live system says.

    Parameters
    ----------
    configuration : Configuration
        Detectors, models and settings.

    Raises
    ------
    ValueError
        When a setting is out of range or models do not fit each other.
    """

    def __init__(self, configuration: Configuration) -> None:
        self._configuration = configuration
        self.around = Surroundings(configuration)
        self.counts = EngineCounts()
        self._known = KnownClasses(dict(configuration.symmetries))
        # What a user may want to know, for the log.
        self.news: deque[str] = deque(maxlen=20)
        # Why the last image was dropped, refused, or taken without odometry.
        self.complaint = ""
        # Why all was forgotten the last time.
        self.why_reset = ""
        self._log: deque[ReadyImage] = deque(maxlen=int(configuration["replay_images"]))
        self._waiting: deque[Image] = deque()
        self._run: LiveRun | None = None
        self._jumped = self._jumped_to_ns = 0
        # An old map that is to be found, the stamp of the next attempt, and what became of the last one.
        self._old: SavedMap | None = None
        self._next_attempt_ns = 0
        self._files = MapFiles()
        self.map_state = ""
        LiveRun(configuration, self._known)  # which refuses what is not valid

    def reset(self) -> None:
        """Forgets objects, the map, odometry, and images that wait; transforms for all times are kept."""
        self._files.loaded = None
        self.lose("all is forgotten")

    def lose(self, why: str) -> None:
        """Forgets as `reset`, for a reason; a map that was loaded is looked for again."""
        self._begin_again(why)
        self._waiting.clear()
        self.around.clear()

    def _begin_again(self, why: str) -> None:
        self.counts.resets += 1
        self.why_reset = why
        self._run, self._old = None, self._files.loaded
        self._files.run_is_lost()
        self.map_state = "" if self._old is None else "is looked for"
        self._jumped = self._next_attempt_ns = 0
        self._log.clear()

    @property
    def is_empty(self) -> bool:
        """Whether nothing was taken in since all was forgotten."""
        return self._run is None

    @property
    def waiting(self) -> int:
        """Number of images that wait."""
        return len(self._waiting)

    @property
    def transforms(self) -> LiveTransforms:
        """The transforms that came."""
        return self.around.transforms

    def set_symmetries(self, symmetries: Mapping[str, SymmetryGroup]) -> LiveEstimate | None:
        """Takes symmetries of classes, also after images: these are played again with them while all are kept.

        Of a longer run the objects go on from where they are, up to the symmetries (`carried_over`). The estimate that
        follows is returned, where there is one.
        """
        changed = {
            name: group
            for name, group in symmetries.items()
            if name not in self._known.symmetries or self._known.symmetries[name] != group
        }
        if not changed:
            return None
        self._known.symmetries.update(changed)
        if self._run is not None:
            self.news.append(f"symmetries of {', '.join(sorted(changed))} came after detections")
        return self._with_other_models()

    def _with_other_models(self, anew: Collection[str] = ()) -> LiveEstimate | None:
        """Goes on with the models as they are known now; those of the classes `anew` begin anew."""
        run, kept = self._run, list(self._log)
        if run is None:
            return None
        if not run.is_whole:
            self._log.clear()
            models = run.models(self._known)
            kept_models = {m.id: m for m in models if m.class_id not in anew}
            run.go_on_with(with_priors(models, carried_over(run.slam, kept_models)))
            return None
        counts, self.counts = self.counts, EngineCounts()
        self._run = None
        self._log.clear()
        found = None
        for ready in kept:
            found = self._take(ready) or found
        if self._run is not None:
            self._run.lineage |= run.lineage
        self.counts = counts
        return found

    def add(self, image: Image) -> None:
        """Takes an image, which waits until `ready` finds what it needs."""
        self.around.see(image)
        # As in LiveEngine::add.
        near = round(self._configuration.stamped.jump_back_s * 1e9)
        place = len(self._waiting)
        while place > 0 and 0 < self._waiting[place - 1].stamp_ns - image.stamp_ns <= near:
            place -= 1
        self._waiting.insert(place, image)
        while len(self._waiting) > int(self._configuration["queue_size"]):
            self._waiting.popleft()
            self.counts.dropped += 1
            self.complaint = "more images wait than queue_size"

    def ready(self, now_s: float) -> list[LiveEstimate]:
        """The estimates after the images that need not wait any more, in the order of their stamps.

        Parameters
        ----------
        now_s : float
            Time by the clock of `Image.arrival_s` [s].
        """
        found = []
        for image in list(self._waiting):
            if image not in self._waiting:  # a jump of the clock has taken it away
                continue
            is_over = now_s - image.arrival_s >= self._configuration["transform_timeout_s"]
            try:
                prepared = self.around.ready(image, is_over=is_over)
            except ValueError as error:
                self._waiting.remove(image)
                self._refuse(str(error))
                continue
            if prepared is None and not is_over:
                continue
            self._waiting.remove(image)
            if prepared is None:
                self.counts.dropped += 1
                self.complaint = self.around.complaint
                continue
            if prepared.odometry is None and self._configuration.has_odometry:
                self.counts.without_odometry += 1
                self.complaint = self.around.complaint
            several = self._known.newly_several(prepared, self._configuration)
            if several:
                self.news.extend(f"there are several objects of the class '{name}'" for name in several)
                self._with_other_models(several)
            estimate = self._take(prepared)
            if estimate is not None:
                found.append(estimate)
        return found

    def _take(self, ready: ReadyImage) -> LiveEstimate | None:
        image, run = ready.image, self._run
        jump = "" if run is None else run.jump_to(image.stamp_ns)
        if jump:
            return self._jump(ready, jump)
        if run is None and ready.odometry is None and self._configuration.motion.model == MotionModel.given:
            # A run whose camera is given begins where it is.
            self.counts.dropped += 1
            self.complaint = self.around.complaint
            return None
        # A world that began without odometry is not that of the odometry.
        if run is not None and run.lacks_odometry and ready.odometry is not None:
            self._begin_again("odometry has come: what was estimated without it is forgotten")
            run = None
        try:
            if run is None:
                run = self._run = LiveRun(
                    self._configuration, self._known, ready.odometry, image.stamp_ns, ready.cameras
                )
            admissions, ignored, is_late = run.put(ready)
        except ValueError as error:
            self._refuse(str(error))
            return None
        self._jumped = 0
        run.is_whole = run.is_whole and len(self._log) < (self._log.maxlen or 0)
        self._log.append(ready)
        self.counts.images += 1
        self.counts.ignored += ignored
        self.counts.observations += len(admissions)
        self.counts.late += admissions.count(StampAdmission.replayed)
        too_late = admissions.count(StampAdmission.too_late) + is_late
        if too_late:
            self.counts.too_late += too_late
            self.complaint = run.why_late(image.stamp_ns)
        try:
            found = run.estimate(image.arrival_s, self.around.body)
        except ValueError as error:  # what was taken in leads nowhere, and stays
            self._refuse(str(error))
            self.lose(f"{error}: all is forgotten")
            return None
        if found is not None and self._old is not None and found.stamp_ns >= self._next_attempt_ns:
            self._find_map(run, self._old, found.stamp_ns)
        return found

    def _refuse(self, why: str) -> None:
        self.counts.refused += 1
        self.complaint = why

    def _jump(self, ready: ReadyImage, why: str) -> LiveEstimate | None:
        """A stamp has jumped: the image is refused, or is the last of enough of them, with which a run begins."""
        near, window = ready.image.stamp_ns, round(self._configuration.stamped.jump_back_s * 1e9)
        # Images of one clock are near each other, and of several moments.
        if self._jumped == 0 or abs(near - self._jumped_to_ns) > window:
            self._jumped = 1
        elif near != self._jumped_to_ns:
            self._jumped += 1
        self._jumped_to_ns = near
        if self._jumped < _JUMPED:
            self._refuse(f"{why}; {_JUMPED} images in succession are taken for another clock")
            return None
        self._begin_again(f"{why}: all before is forgotten")
        self._waiting = deque(image for image in self._waiting if abs(image.stamp_ns - near) <= window)
        return self._take(ready)

    # --- maps

    def save(self, path: str, *, over_unknown: bool = True) -> None:
        """Saves all that is known, also in place of a map that is looked for unless told otherwise.

        Raises
        ------
        ValueError
            Before the first image, when there is nothing to save, and for a map that must not be written over.
        OSError
            When the file cannot be written.
        """
        if self._run is None:
            raise ValueError("nothing was seen so far, so that there is no map to save")
        if not over_unknown:
            self._files.require_kept(path)
        self._files.was_saved(path, write_map(path, self._run.saved(self.around.body, self._known)))

    def load(self, path: str, *, go_on: bool = False) -> str:
        """Loads a map, and says what becomes of it.

        It is found in the world of the run as soon as enough of its objects are seen again. To `go_on`, before the
        first image, the run is that of the map: odometry must be, too.

        Raises
        ------
        ValueError
            For a file that is no map, one that cannot go on, and one whose images are in the run already.
        OSError
            When it cannot be read.
        """
        found = read_map(path)
        if go_on and self._run is None:
            self._run = LiveRun.of_saved(self._configuration, self._known, found)
            self.around.body = found.body
            # The run changes what was read first.
            self._files.was_loaded(path, read_map(path), is_in_run=True)
            self._old, self.map_state = None, "goes on"
            return f"the run of {path} goes on, with {found.objects} objects"
        if self._run is not None and found.lineage & {*self._run.lineage, *self._files.saved}:
            raise ValueError(f"{path} is a map of this run, or one that was found in it: it tells nothing new")
        self._old, self._next_attempt_ns, self.map_state = found, 0, "is looked for"
        self._files.was_loaded(path, found, is_in_run=False)
        if self._run is not None:
            last = self._run.slam.finish()
            if last is not None:
                self._find_map(self._run, found, 0)
        return f"{path} has {found.objects} objects; the map {self.map_state}"

    def _find_map(self, run: LiveRun, old: SavedMap, stamp_ns: int) -> None:
        self._next_attempt_ns = stamp_ns + round(_ATTEMPTS_S * 1e9)
        found = relocalise(old.slam, run.slam)
        self.map_state = f"is looked for: {found.outcome.name}, {len(found.agreed)} objects agree"
        if found.outcome == RelocaliseOutcome.found:
            # One nut of a run may be any of several in the old map, and is of their class from now on.
            self._known.several |= old.several
            models = run.models(self._known, old.slam.objects)
            run.go_on_with(merged(old.slam, run.slam, found, models))
            run.lineage |= old.lineage
            self._log.clear()
            self._old = None
            self._files.was_found()
            self.map_state = f"was found by {len(found.agreed)} objects"
            self.news.append(f"the map {self.map_state}")

    def forget(self, names: Sequence[str]) -> LiveEstimate | None:
        """Forgets single objects, and returns the estimate without them.

        Raises
        ------
        ValueError
            For a name that there is not, naming those that there are; nothing is changed.
        """
        if self._run is None:
            raise ValueError("nothing was seen so far; known are: none")
        self._run.forget(names)
        self._log.clear()
        return self._run.estimate(0.0, self.around.body)
