!> Largest storey drifts of a yielding frame.
module rwmf_simulation_recorder_storey_drifts
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_math_sign_changes, only: no_change
   use rwmf_simulation_events_first_change, only: stop_at_change
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, step_view_t
   use rwmf_simulation_events_storey_events, only: displacements_t
   use rwmf_simulation_events_watched_spans, only: changes_in, kept_samples_t, moment_t, &
      sample_functions, span_between, span_of, span_t, watch_t
   implicit none
   private

   public :: observe_drifts, observe_turns

contains

   !> Update the largest drifts with a state.
   subroutine observe_drifts(largest, equation, y)
      real(wp), intent(inout) :: largest(:)
      !! (n) largest |u_i - u_(i-1)| so far [m]
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(size(largest))
      real(wp) :: d_dot(size(largest))

      call storey_motion(equation, equation%state%side, y, d, d_dot)
      largest = max(largest, abs(d))
   end subroutine observe_drifts

   !> Update the largest displacements with the turning points inside a piece of the last step and
   !> its end.
   subroutine observe_turns(largest, times, displacements, step, error)
      real(wp), intent(inout) :: largest(:)
      !! (storeys) largest |u_i - u_(i-1)| so far [m]
      real(wp), intent(inout) :: times(:)
      !! (storeys) when [s]
      class(displacements_t), intent(in) :: displacements
      !! which ones
      type(step_view_t), intent(in) :: step
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      class(displacements_t), allocatable :: floors
      type(kept_samples_t), target :: samples
      type(moment_t) :: before, after
      type(span_t) :: span
      integer :: n, i, k

      allocate (floors, source=displacements)
      floors%step = step
      n = count_parts(step)
      if (n == 1) then
         if (is_inside(largest, times, floors)) return
      end if
      floors%samples => samples
      call sample_functions(floors, step%t_a, after, error)
      do i = 1, n
         if (allocated(error)) return
         before = after
         call sample_functions(floors, end_of_part(step, i, n), after, error)
         if (allocated(error)) return
         span = span_between(floors, before, after)
         do k = 1, size(largest)
            call follow_turns(largest(k), times(k), floors, k, span, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine observe_turns

   !> True if the ends of a short piece exclude larger displacements between them.
   !>
   !> The end of the piece updates the largest displacements.
   logical function is_inside(largest, times, floors)
      real(wp), intent(inout) :: largest(:), times(:)
      class(displacements_t), intent(inout) :: floors
      type(span_t) :: span
      integer :: k

      floors%derivatives = 1
      span = span_of(floors)
      floors%derivatives = 2
      associate (b => span%b)
         where (abs(b%f(:, 0)) > largest)
            largest = abs(b%f(:, 0))
            times = b%t
         end where
      end associate
      is_inside = .true.
      do k = 1, size(largest)
         is_inside = is_inside .and. stays_within(largest(k), k, span)
      end do
   end function is_inside

   !> True if a span provably has no larger drift of a storey.
   !>
   !> A storey that moves very little compared with the others counts as well, because it reaches
   !> its largest drift later.
   logical function stays_within(largest, k, span)
      real(wp), intent(in) :: largest
      !! [m]
      integer, intent(in) :: k
      !! number of the storey, from the ground
      type(span_t), intent(in) :: span
      real(wp), parameter :: hardly = 1.0e-6_wp
      !! negligible part of the largest drift of all storeys [-]

      stays_within = largest < hardly*span%largest(0)
      if (stays_within) return
      stays_within = changes_in(span, watch_t(k, 0, level=-largest, side=1.0_wp)) == no_change
      if (stays_within) stays_within = changes_in(span, watch_t(k, 0, level=largest, &
         side=-1.0_wp)) == no_change
   end function stays_within

   !> Update the largest displacement with its turning points in a span and the end.
   subroutine follow_turns(largest, time, floors, k, span, error)
      real(wp), intent(inout) :: largest
      !! [m]
      real(wp), intent(inout) :: time
      !! when [s]
      class(displacements_t), intent(in) :: floors
      integer, intent(in) :: k
      !! number of the storey, from the ground
      type(span_t), intent(in) :: span
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_turns = 100
      type(span_t) :: rest, part
      real(wp) :: way
      logical :: turns
      integer :: i

      call keep(span%b)
      rest = span
      do i = 1, most_turns
         if (stays_within(largest, k, rest)) return
         way = rest%a%f(k, 1)
         if (abs(way) <= 0) way = rest%a%f(k, 2)
         part = rest
         call stop_at_change(floors, watch_t(k, 1, side=sign(1.0_wp, way)), part, turns, error)
         if (allocated(error) .or. .not. turns) return
         call keep(part%b)
         if (.not. part%b%t > rest%a%t .or. .not. span%b%t > part%b%t) return
         rest = span_between(floors, part%b, span%b)
      end do

   contains

      !> Let an instant take part.
      subroutine keep(moment)
         type(moment_t), intent(in) :: moment

         if (.not. abs(moment%f(k, 0)) > largest) return
         largest = abs(moment%f(k, 0))
         time = moment%t
      end subroutine keep
   end subroutine follow_turns

end module rwmf_simulation_recorder_storey_drifts
