!> How far the storeys of a frame have been displaced, where they yield.
module rwmf_simulation_recorder_storey_drifts
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: equation_t
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_math_sign_changes, only: no_change
   use rwmf_simulation_events_first_change, only: changes_in, moment_t, sample_functions, &
      samples_t, span_between, span_t, stop_at_change, watch_t
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, step_view_t
   use rwmf_simulation_events_storey_events, only: displacements_t
   implicit none
   private

   public :: observe_drifts, observe_turns

contains

   !> Let a state take part in the largest displacements.
   subroutine observe_drifts(largest, equation, y)
      real(wp), intent(inout) :: largest(:)
      !! (n) of |u_i - u_(i-1)| so far [m]
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(size(largest))
      real(wp) :: d_dot(size(largest))

      call storey_motion(equation, equation%state%side, y, d, d_dot)
      largest = max(largest, abs(d))
   end subroutine observe_drifts

   !> Let the turns inside a piece of the last step, and its end, take part in them.
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
      class(displacements_t), allocatable :: storeys
      type(samples_t), target :: samples
      type(moment_t) :: before, after
      type(span_t) :: span
      integer :: n, i, k

      allocate (storeys, source=displacements)
      storeys%step = step
      n = count_parts(step)
      if (n == 1) then
         if (is_inside(largest, times, storeys)) return
      end if
      storeys%samples => samples
      call sample_functions(storeys, step%t_a, after, error)
      do i = 1, n
         if (allocated(error)) return
         before = after
         call sample_functions(storeys, end_of_part(step, i, n), after, error)
         if (allocated(error)) return
         span = span_between(storeys, before, after)
         do k = 1, size(largest)
            call follow_turns(largest(k), times(k), storeys, k, span, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine observe_turns

   !> Is it plain from the ends of a short piece, the last of which takes part, that no storey goes
   !> farther out between them?
   logical function is_inside(largest, times, storeys)
      real(wp), intent(inout) :: largest(:), times(:)
      class(displacements_t), intent(inout) :: storeys
      type(moment_t) :: a, b
      type(span_t) :: span
      integer :: k

      a%t = storeys%step%t_a
      b%t = storeys%step%t_b
      storeys%derivatives = 1
      call storeys%evaluate(a%t, storeys%step%y_a, a%f)
      call storeys%evaluate(b%t, storeys%step%y_b, b%f)
      storeys%derivatives = 2
      where (abs(b%f(:, 0)) > largest)
         largest = abs(b%f(:, 0))
         times = b%t
      end where
      span = span_between(storeys, a, b)
      is_inside = .true.
      do k = 1, size(largest)
         is_inside = is_inside .and. stays_within(largest(k), k, span)
      end do
   end function is_inside

   !> Is it plain that a storey does not go farther out than ever in a span? One that hardly moves
   !> beside the others, before their motion reaches it, has its largest displacement later.
   logical function stays_within(largest, k, span)
      real(wp), intent(in) :: largest
      !! [m]
      integer, intent(in) :: k
      !! number of the storey, from the ground
      type(span_t), intent(in) :: span
      real(wp), parameter :: hardly = 1.0e-6_wp
      !! of the largest displacement of all storeys [-]

      stays_within = largest < hardly*span%largest(0)
      if (stays_within) return
      stays_within = changes_in(span, watch_t(k, 0, level=-largest, side=1.0_wp)) == no_change
      if (stays_within) stays_within = changes_in(span, watch_t(k, 0, level=largest, &
         side=-1.0_wp)) == no_change
   end function stays_within

   !> Let the turns of a storey in a span, and its end, take part.
   subroutine follow_turns(largest, time, storeys, k, span, error)
      real(wp), intent(inout) :: largest
      !! [m]
      real(wp), intent(inout) :: time
      !! when [s]
      class(displacements_t), intent(in) :: storeys
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
         call stop_at_change(storeys, watch_t(k, 1, side=sign(1.0_wp, way)), part, turns, error)
         if (allocated(error) .or. .not. turns) return
         call keep(part%b)
         if (.not. part%b%t > rest%a%t .or. .not. span%b%t > part%b%t) return
         rest = span_between(storeys, part%b, span%b)
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
