!> Batch of runs that advance by Taylor series (`series_batch_t`), and the scenes that it serves.
module rwmf_simulation_series_series_batch
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_series_series_kernels, only: series_kernels_of, series_kernels_t
   use rwmf_integrator_series_series_lanes, only: most_lines, series_lanes_t, series_width
   use rwmf_model_effects_numbers, only: inerter_effect, p_delta_effect, storeys_effect, &
      vertical_effect
   use rwmf_model_elements, only: chord_row, of_fuse, of_restraint
   use rwmf_model_equation, only: equation_t, has_elements, has_tendons
   use rwmf_model_lanes, only: chord_coefficients
   use rwmf_model_scene, only: axis_term, chord_term, frame_term, line_term, rise_term
   use rwmf_model_stroke, only: along_line
   use rwmf_motion_ground_motion, only: interval_end, interval_last, is_curved, &
      is_piecewise_linear, line_of, line_t, &
      motion_t, vertical_line_of
   implicit none
   private

   public :: series_batch_t, create_series_batch, is_served, needs_rises
   public :: at_lower, at_upper, at_turn
   public :: demand_t, of_reactions, of_building, of_envelopes

   integer, parameter :: at_lower = 0
   integer, parameter :: at_upper = 1
   integer, parameter :: at_turn = 2
   integer, parameter :: of_reactions = 1, of_building = 2, of_envelopes = 3
   !! families of demands

   !> Demand that the runs of a batch record.
   type :: demand_t
      integer :: family = 0
      !! one of the numbers above: the search that records it
      integer :: number = 0
      !! number in this search
   end type demand_t

   !> Runs that step together.
   type :: series_batch_t
      type(series_lanes_t) :: lanes
      type(series_kernels_t) :: kernels
      integer :: interval(series_width) = 0
      !! number of the interval of the motion of each lane
      logical :: is_busy(series_width) = .false.
      !! the lane has a run
      logical :: is_curved(series_width) = .false.
      !! `lanes%curve` of the lane is not zero
      real(wp) :: last(series_width, 2) = 2
      !! by side: phi at which the run ends, overturned or collapsed [rad]
      integer :: ending(series_width) = at_lower
      !! one of the `at_` numbers: the end of the window at the event of each lane
      type(demand_t), allocatable :: demands(:)
      !! (demands) those that the runs record
      logical :: has_ended = .true.
      !! a run is over, or a lane has none
      real(wp), allocatable :: lines(:, :)
      !! (6, intervals of the motion from 0) end [s], a_0 [m/s2], slope [m/s3], t_0 [s], vertical
      !! a_0 and slope. The end is negative where a lane has to enter the interval by itself: too
      !! short, the last one, or inside a pulse.
      integer :: steps_left = 0
      !! number of common steps until the numbers of steps are checked
   end type series_batch_t

contains

   !> Create a batch with finite numbers in its idle lanes.
   subroutine create_series_batch(level, order, batch, motion, t_end, seeks_speed)
      integer, intent(in) :: level
      !! instruction set, as for `series_kernels_of`
      integer, intent(in) :: order
      !! of the series
      type(series_batch_t), intent(out) :: batch
      type(motion_t), intent(in), optional :: motion
      !! common to all lanes
      real(wp), intent(in), optional :: t_end
      !! end of all runs; present with a motion [s]
      logical, intent(in), optional :: seeks_speed
      !! the largest velocity is sought; default false

      batch%kernels = series_kernels_of(level, order)
      batch%lanes = idle_lanes()
      if (present(seeks_speed)) batch%lanes%seeks_speed = seeks_speed
      if (present(motion)) then
         call tabulate(motion, t_end, batch%lines)
      else
         allocate (batch%lines(6, 0:0), source=-1.0_wp)
      end if
   end subroutine create_series_batch

   !> Tabulate the straight lines of a motion.
   pure subroutine tabulate(motion, t_end, lines)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t_end
      !! [s]
      real(wp), allocatable, intent(out) :: lines(:, :)
      type(line_t) :: line, upward
      real(wp) :: begin, limit
      integer :: i

      allocate (lines(6, 0:interval_last(motion)))
      begin = 0
      do i = 0, interval_last(motion)
         line = line_of(motion, i)
         limit = interval_end(motion, i)
         upward = vertical_line_of(motion, i, line)
         lines(:, i) = [limit, line%a_0, line%slope, line%t_0, upward%a_0, upward%slope]
         if (limit - begin <= 8*epsilon(limit)*limit .or. limit >= t_end &
             .or. is_curved(motion, i)) lines(1, i) = -1
         begin = limit
      end do
   end subroutine tabulate

   !> Numbers of lanes without a run, with which the loops compute without an exception.
   pure type(series_lanes_t) function idle_lanes() result(lanes)
      lanes%t = 0
      lanes%limit = 1
      lanes%length = 1
      lanes%share = 1
      lanes%longest = 1
      lanes%ground = 0
      lanes%upward = 0
      lanes%curve = 0
      lanes%weight_share = 0
      lanes%side = 1
      lanes%phi = 1
      lanes%rate = 0
      lanes%multiplicity = 0
      lanes%above = 0
      lanes%inverse_radius = 1
      lanes%cosine = 1
      lanes%sine_wall = 0
      lanes%sine_link = 0
      lanes%sine_lever = 0
      lanes%inertia = 1
      lanes%gravity = 0
      lanes%mass = 0
      lanes%damping = 0
      lanes%stiffness = 0
      lanes%offset = 0
      lanes%cable = 0
      lanes%cable_slope = 0
      lanes%fuse = 0
      lanes%fuse_slope = 0
      lanes%damper = 0
      lanes%inerter = 0
      lanes%excited = 1
      lanes%straight = 1
      lanes%straight(:, :2, :, :) = 0
      lanes%rtol = 1
      lanes%least_size = 1
      lanes%allowance = 1
      lanes%frequency = 1
      lanes%lower = 0
      lanes%upper = 2
      lanes%turn = 0
      lanes%top = 1
      lanes%t_top = 0
      lanes%fastest = 1
      lanes%top_speed = 1
      lanes%base = 0
      lanes%rise = 0
      lanes%factor = 1
      lanes%uplift = 1
      lanes%gain = 1
      lanes%settled = 0
      lanes%negligible = 0
      lanes%impacts = 0
      lanes%steps = 0
      lanes%is_busy = 0
      lanes%needs_care = 0
      lanes%is_at_limit = 0
   end function idle_lanes

   !> Return whether the series knows all terms of a scene. They are a rocking wall, a frame,
   !> cables, springs with memory, devices at the corners, vertical motion and gravity on the frame.
   pure logical function is_served(equation)
      type(equation_t), intent(in) :: equation
      integer, parameter :: known(*) = [frame_term, axis_term, line_term, chord_term, &
         rise_term, inerter_effect, vertical_effect, p_delta_effect, storeys_effect]
      integer :: i

      is_served = equation%has_impacts .and. equation%n == 2 .and. .not. ( &
         equation%has_loading_direction .or. equation%creep > 0 .or. equation%geometry%link > 0)
      do i = 1, size(equation%scene%terms)
         is_served = is_served .and. any(known == equation%scene%terms(i)%effect)
      end do
      if (needs_rises(equation)) is_served = is_served .and. is_piecewise_linear(equation%motion)
      if (is_served .and. has_elements(equation)) is_served = serves_elements(equation)
   end function is_served

   !> Return whether a scene needs the loop of restraints, couplings and several straight tendons,
   !> which has no pulses.
   pure logical function needs_rises(equation)
      type(equation_t), intent(in) :: equation

      needs_rises = any(equation%scene%terms%effect == rise_term)
      if (has_elements(equation)) needs_rises = needs_rises .or. count( &
         equation%elements%stroke%kind == along_line) > 1
   end function needs_rises

   !> Return whether the series knows the elements of a scene: few straight tendons, equal damping
   !> on both sides, and springs that never lift the wall off both corners.
   pure logical function serves_elements(equation) result(is_served)
      type(equation_t), intent(in) :: equation
      real(wp) :: capacity, rows(chord_coefficients, 2)

      capacity = equation%p%g
      if (.not. has_tendons(equation)) capacity = capacity*(1 + equation%p%eta_0)
      rows(:, 1) = chord_row(equation%elements, equation%state%springs, -1, equation%p%R)
      rows(:, 2) = chord_row(equation%elements, equation%state%springs, 1, equation%p%R)
      is_served = abs(rows(3, 1) - rows(3, 2)) <= 0 .and. push_of(equation) <= capacity &
         .and. count(equation%elements%stroke%kind == along_line) <= most_lines
   end function serves_elements

   !> Largest force with which fuses and restraints may push the wall up, over m_w [m/s2].
   pure real(wp) function push_of(equation) result(push)
      type(equation_t), intent(in) :: equation
      integer :: i

      push = 0
      do i = 1, size(equation%elements)
         associate (element => equation%elements(i))
            if (all(element%group /= [of_fuse, of_restraint]) .or. element%spring == 0) cycle
            associate (spring => equation%springs(element%spring)%spring)
               push = push + element%weight*spring%breakaway*spring%yield
            end associate
         end associate
      end do
   end function push_of

end module rwmf_simulation_series_series_batch
